#include "range/curve_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"
#include "range/lanes.hpp"
#include "range/point_block.hpp"

namespace beltpick::range {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

constexpr float kFarthestMm = 1e6F;
constexpr float kLeastAmplitude = 1e-3F;
// Of four corners, a parabola's outer two stand 4 kBlock^2 bend above the inner two, all told.
constexpr float kPerBend = 1.0F / (4 * kBlock * kBlock);

// Depths of a block from codes and modulation. `sigma` holds the variance of the fringes' levels, over the square of
// CodeNoise::slope_px, and gets that of the distance along the ray, in mm^2.
BELTPICK_INLINE void block_of(const CurveRow& curves, float floor_variance, int block, const float* code_px,
                              const float* modulation, float* __restrict depth_mm, float* __restrict sigma) {
  const Curve& at = curves.at[block];
  const Curve& slope = curves.slope[block];
  const Curve& bend = curves.bend[block];
  const auto bent_term = [&](std::size_t k) {
    return at.per_z[k] + (slope.per_z[k] + bend.per_z[k] * kPixel) * kPixel;
  };
  const auto depth_term = [&](std::size_t k) { return at.per_z[k] + slope.per_z[k] * kPixel; };
  const auto other_term = [&](std::size_t k) { return at.other_px[k] + slope.other_px[k] * kPixel; };
  const Lanes x = *loose(code_px) - curves.centre_px;
  // Horner's scheme for 1 / z and, beside it, for its derivative.
  Lanes w = at.per_z[6] * x + at.per_z[5];
  Lanes per_code = at.per_z[6] * x + w;
  w = w * x + at.per_z[4];
  per_code = per_code * x + w;
  w = w * x + depth_term(3);
  per_code = per_code * x + w;
  w = w * x + depth_term(2);
  per_code = per_code * x + w;
  w = w * x + bent_term(1);
  per_code = per_code * x + w;
  w = w * x + bent_term(0);
  const Lanes other_px = (at.other_px[2] * x + other_term(1)) * x + other_term(0);
  const Lanes amplitude = *loose(modulation) > kLeastAmplitude ? *loose(modulation) : Lanes{} + kLeastAmplitude;
  const Lanes amplitude_squared = amplitude * amplitude;
  const Lanes per_both = 1.0F / (w * amplitude_squared);  // two quotients for one division
  const Lanes z = per_both * amplitude_squared;
  const Lanes mm_per_px = per_code * (z * z);
  const Lanes variance_px = floor_variance + *loose(sigma) * (per_both * w);
  const Lanes length_squared = at.length_squared + slope.length_squared * kPixel;
  // Positive where both are; of NaN, not.
  const Lanes after_px = other_px - curves.first_other_px;
  const Lanes before_px = curves.last_other_px - other_px;
  const Lanes within_px = after_px < before_px ? after_px : before_px;
  const Lanes near = w - 1.0F / kFarthestMm;
  const Lanes good = near < within_px ? near : within_px;
  *loose(depth_mm) = good > 0.0F ? z : Lanes{};
  *loose(sigma) = variance_px * (length_squared * (mm_per_px * mm_per_px));
}

// Those pixels of a row that do not fill a block.
BELTPICK_INLINE void tail_of(const CurveRow& curves, float floor_variance, int block, int count, const AxisInput& in,
                             float* depth_mm, float* sigma) {
  alignas(64) std::array<float, kBlock> code_px{};
  alignas(64) std::array<float, kBlock> modulation{};
  const int first = block * kBlock;
  std::copy(in.code_px + first, in.code_px + count, code_px.begin());
  std::copy(in.modulation + first, in.modulation + count, modulation.begin());
  block_of(curves, floor_variance, block, code_px.data(), modulation.data(), depth_mm + first, sigma + first);
}

}  // namespace

BELTPICK_KERNEL
void curves_between(const Curve* up, const Curve* down, float below, int blocks, Curve* at, Curve* slope, Curve* bend) {
  static_assert(sizeof(Curve) == sizeof(Lanes) && kDepthTerms == 7 && kOtherTerms == 3);
  constexpr float kHalf = 0.5F * kBlock;
  constexpr Lanes kSettle = {0, 0, 0, 0, kHalf, kHalf, kHalf, 0, 0, kHalf};  // to the middle of the block
  constexpr Lanes kBent = {1, 1};
  const auto* __restrict upper = reinterpret_cast<const Lanes*>(up);
  const auto* __restrict lower = reinterpret_cast<const Lanes*>(down);
  auto* __restrict at_left = reinterpret_cast<Lanes*>(at);
  auto* __restrict slopes = reinterpret_cast<Lanes*>(slope);
  auto* __restrict bends = reinterpret_cast<Lanes*>(bend);
  const auto corner = [&](int i) { return upper[i] + (lower[i] - upper[i]) * below; };
  Lanes before = corner(0);
  Lanes left = corner(1);
  Lanes right = corner(2);
  for (int i = 0; i < blocks; ++i) {
    const Lanes after = corner(i + 3);
    const Lanes bent = ((before - left) - (right - after)) * (kPerBend * kBent);
    const Lanes each = (right - left) * (1.0F / kBlock) - kBlock * bent;
    bends[i] = bent;
    slopes[i] = each;
    at_left[i] = left + kSettle * each;
    before = left;
    left = right;
    right = after;
  }
}

BELTPICK_KERNEL
void depth_row(const CurveRow& curves, const AxisInput& in, int count, float* depth_mm, float* sigma_mm,
               const PointRow* waiting) {
  const float slope_squared = in.noise.slope_px * in.noise.slope_px;
  // The texture is what white light shows; a fringe's mean is half of it.
  const float dark = slope_squared * kCameraNoise.floor_variance;
  const float per_level = slope_squared * (0.5F * kCameraNoise.shot_variance_per_level);
  const float floor_variance = in.noise.floor_px * in.noise.floor_px;
  for (int i = 0; i < count; ++i) sigma_mm[i] = dark + per_level * static_cast<float>(in.texture[i]);
  int at = 0;
  for (; at + kBlock <= count; at += kBlock) {
    block_of(curves, floor_variance, at / kBlock, in.code_px + at, in.modulation + at, depth_mm + at, sigma_mm + at);
    if (waiting != nullptr) write_block(*waiting, at, count);
  }
  if (at < count) {
    tail_of(curves, floor_variance, at / kBlock, count, in, depth_mm, sigma_mm);
    if (waiting != nullptr) write_block(*waiting, at, count);
  }
  for (int i = 0; i < count; ++i) sigma_mm[i] = std::sqrt(sigma_mm[i]);
}

BELTPICK_KERNEL
void parabolas_through(const float* __restrict corners, int blocks, float* __restrict slope, float* __restrict bend) {
  for (int k = 0; k < blocks; ++k) {
    bend[k] = ((corners[k] - corners[k + 1]) - (corners[k + 2] - corners[k + 3])) * kPerBend;
    slope[k] = (corners[k + 2] - corners[k + 1]) * (1.0F / kBlock) - kBlock * bend[k];
  }
}

}  // namespace beltpick::range
