// What folding does to one row of pixels, for cameras of 8 and of 16 bits. Internal to decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "decode/plan.hpp"

namespace beltpick::decode {

// Frames of one fringe that are added in one go, so that the sums travel to memory and back once for all of them.
template <class Pixel>
struct FringeRows {
  int count = 0;  // 1 .. kMaxTogether
  std::array<const Pixel*, kMaxTogether> levels{};
  std::array<float, kMaxTogether> cosine_weight{}, sine_weight{};
  std::array<std::int16_t, kMaxTogether> cosine_weight_q15{}, sine_weight_q15{};
  bool first = false;        // sets sums and mean instead of adding to them
  bool first_flags = false;  // sets the flags instead of adding to them
  int full_scale = 255;
  std::uint8_t saturation_bit = 1;
};

// Adds phase frames to the sums of their fringe and, where `mean` is not null, to their sum.
//   8 bits: sum += round((level << 7) * weight_q15 / 2^15), rounded term by term; 16 bits: sum += level * weight.
// flags |= saturation_bit where a level has reached full_scale.
void accumulate_row(const FringeRows<std::uint8_t>& rows, int count, std::int16_t* cosine, std::int16_t* sine,
                    std::uint16_t* mean, std::uint8_t* flags);
void accumulate_row(const FringeRows<std::uint16_t>& rows, int count, float* cosine, float* sine, float* mean,
                    std::uint8_t* flags);

void widen_extremes_row(const std::uint8_t* levels, int count, bool first, std::uint8_t* white, std::uint8_t* black);
void widen_extremes_row(const std::uint16_t* levels, int count, bool first, std::uint16_t* white, std::uint16_t* black);

// Where the bit of 8-bit twins is weak by noise alone: their difference is less than `always`, or exceeds it by no more
// than the number of the levels `above` that their mean, rounded up, lies above.
struct TwinMargins {
  static constexpr std::size_t kSteps = 8;
  bool known = false;  // false: noise needs more steps
  std::uint8_t always = 0;
  std::array<std::uint8_t, kSteps> above{};  // ascending; 255: never
};
inline constexpr float kTwinNoiseFactor = 0.5F;  // half the difference of two frames
TwinMargins twin_margins(float to_level8);

// How far 8-bit levels reach from a threshold midway between white and black: `always`, and one more for each of the
// sums of white and black `above` that theirs exceeds.
struct MidpointReaches {
  static constexpr std::size_t kSteps = 8;
  bool known = false;  // false: noise needs more steps
  std::uint8_t always = 0;
  std::array<std::uint16_t, kSteps> above{};  // ascending; 0xFFFF: never
};
inline constexpr float kMidpointNoiseFactor = 1.5F;  // one frame against the mean of two
MidpointReaches midpoint_reaches(float to_level8);

// How the level that parts bright from dark is found.
struct ThresholdRule {
  float to_level8 = 1.0F;                             // 255 / full_scale
  float scale = 1.0F;                                 // of the threshold
  float noise_factor = 1.0F;                          // variance of (level - threshold) over that of one grey level
  float weak_fraction = 0.0F;                         // see GrayCode
  const TwinMargins* twin_margins = nullptr;          // the same worked out for twins; may be null
  const MidpointReaches* midpoint_reaches = nullptr;  // and for a threshold midway; may be null
};

// A Gray frame's threshold in whole levels: bright is above `level`; a bit is weak where a threshold moved by `reach`
// levels would turn it: nearer than three standard deviations of the camera's noise, or than weak_fraction of half the
// contrast (of the threshold itself where no black tells the contrast). At least one level.
//   midway between white and black, times scale; or mean times scale
void midpoint_threshold_row(const std::uint8_t* white, const std::uint8_t* black, int count, const ThresholdRule& rule,
                            std::uint8_t* level, std::uint8_t* reach);
void midpoint_threshold_row(const std::uint16_t* white, const std::uint16_t* black, int count,
                            const ThresholdRule& rule, std::uint16_t* level, std::uint16_t* reach);
void mean_threshold_row(const std::uint16_t* mean, int count, const ThresholdRule& rule, std::uint8_t* level,
                        std::uint8_t* reach);
void mean_threshold_row(const float* mean, int count, const ThresholdRule& rule, std::uint16_t* level,
                        std::uint16_t* reach);

// A row of one Gray bit: bit_row_bytes(count) bytes, the first half for the bits, the second for where they are weak.
// Bit s of byte j is that of pixel s * W + j, W the bytes of a half: pixels that vector units take together lie beside
// each other, and packing needs no shuffling.
constexpr std::size_t bit_row_bytes(int count) { return 2 * ((static_cast<std::size_t>(count) + 7) / 8); }

// Bit 1 where the level lies above the threshold, or below it where `inverted`.
void resolve_levels_row(const std::uint8_t* levels, const std::uint8_t* level, const std::uint8_t* reach, int count,
                        bool inverted, std::uint8_t* bits);
void resolve_levels_row(const std::uint16_t* levels, const std::uint16_t* level, const std::uint16_t* reach, int count,
                        bool inverted, std::uint8_t* bits);
// Bit 1 where the upright frame is brighter than its inverted twin; weak as above, the threshold midway between both.
void resolve_twin_row(const std::uint8_t* upright, const std::uint8_t* inverted, int count, const ThresholdRule& rule,
                      std::uint8_t* bits);
void resolve_twin_row(const std::uint16_t* upright, const std::uint16_t* inverted, int count, const ThresholdRule& rule,
                      std::uint8_t* bits);

}  // namespace beltpick::decode
