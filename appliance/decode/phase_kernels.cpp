#include "decode/phase_kernels.hpp"

#include <algorithm>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

// atan(r) / 2 pi for r in [0, 1]: Abramowitz and Stegun 4.4.49 (error below 2e-8 rad) over 2 pi.
BELTPICK_INLINE float octant_turns(float r) {
  constexpr float kTurn = 0.15915494309F;
  const float q = r * r;
  const float q2 = q * q;
  const float q4 = q2 * q2;
  // In pairs of terms, which vector units work out side by side.
  const float p01 = 1.0F - 0.3333314528F * q;
  const float p23 = 0.1999355085F - 0.1420889944F * q;
  const float p45 = 0.1065626393F - 0.0752896400F * q;
  const float p67 = 0.0429096138F - 0.0161657367F * q;
  const float p = (p01 + p23 * q2) + (p45 + p67 * q2 + (0.0028662257F * q4)) * q4;
  return p * r * kTurn;
}

// The same in parts of a turn, by Abramowitz and Stegun 4.4.47: a tenth of a part off at most.
BELTPICK_INLINE float octant_parts(float r) {
  constexpr float kParts = 0.15915494309F * kPartsOfTurn;
  const float q = r * r;
  const float p01 = 0.9998660F * kParts - 0.3302995F * kParts * q;
  const float p23 = 0.1801410F * kParts - 0.0851330F * kParts * q;
  return (p01 + (p23 + 0.0208351F * kParts * (q * q)) * (q * q)) * r;
}

// sqrt(1 + r^2) for r in [0, 1], by a fit at Chebyshev's places: 1.2e-5 off at most. Takes the processor half the time
// of a root.
BELTPICK_INLINE float octant_length(float r) {
  const float q = r * r;
  const float p01 = 1.0000111F + 0.49940469F * q;
  const float p23 = 0.044864776F * q - 0.11972383F;
  return p01 + (p23 - 0.010351832F * (q * q)) * (q * q);
}

// A vector by its octant: the longer component, and the shorter one over it.
struct Octant {
  float longer, ratio;
};
BELTPICK_INLINE Octant octant_of(float sine, float cosine) {
  const float s = std::fabs(sine);
  const float c = std::fabs(cosine);
  const float longer = std::max(std::max(s, c), 1e-20F);
  return {longer, std::min(s, c) / longer};
}
// The angle of (cosine, sine) in [-turn / 2, turn / 2] from that within its octant.
BELTPICK_INLINE float angle(float sine, float cosine, float within, float turn) {
  float t = std::fabs(sine) > std::fabs(cosine) ? 0.25F * turn - within : within;
  t = cosine < 0.0F ? 0.5F * turn - t : t;
  return sine < 0.0F ? -t : t;
}

}  // namespace

BELTPICK_KERNEL
void phase_row(std::int16_t* __restrict cosine_to_turn, std::int16_t* __restrict sine_to_amplitude, int count) {
  for (int i = 0; i < count; ++i) {
    const auto c = static_cast<float>(cosine_to_turn[i]);
    const auto s = static_cast<float>(sine_to_amplitude[i]);
    const Octant octant = octant_of(s, c);
    const float parts = angle(s, c, octant_parts(octant.ratio), kPartsOfTurn);
    // Half a turn either way is the same: it may wrap. A turn is added, so that the cut to whole numbers rounds.
    cosine_to_turn[i] = static_cast<std::int16_t>(static_cast<int>(parts + (kPartsOfTurn + 0.5F)));
    sine_to_amplitude[i] =
        static_cast<std::int16_t>(static_cast<int>(octant.longer * octant_length(octant.ratio) + 0.5F));
  }
}

BELTPICK_KERNEL
void phase_row(float* __restrict cosine_to_turn, float* __restrict sine_to_amplitude, int count) {
  for (int i = 0; i < count; ++i) {
    const float c = cosine_to_turn[i];
    const float s = sine_to_amplitude[i];
    cosine_to_turn[i] = angle(s, c, octant_turns(octant_of(s, c).ratio), 1.0F);
    sine_to_amplitude[i] = std::sqrt(c * c + s * s);
  }
}

BELTPICK_KERNEL
void fringe_row(const std::int16_t* turn, const std::int16_t* amplitude, int count, float scale, float* turn_out,
                float* amplitude8) {
  for (int i = 0; i < count; ++i) {
    turn_out[i] = static_cast<float>(turn[i]) * (1.0F / kPartsOfTurn);
    amplitude8[i] = static_cast<float>(static_cast<std::uint16_t>(amplitude[i])) * scale;
  }
}

BELTPICK_KERNEL
void fringe_row(const float* turn, const float* amplitude, int count, float scale, float* turn_out, float* amplitude8) {
  for (int i = 0; i < count; ++i) {
    turn_out[i] = turn[i];
    amplitude8[i] = amplitude[i] * scale;
  }
}

}  // namespace beltpick::decode
