// Depths and rays of a row of camera pixels from curves worked out ahead, a block of pixels at a time. Internal to
// range.
#pragma once

#include <array>

#include "range/axis_kernel.hpp"
#include "range/point_kernel.hpp"

namespace beltpick::range {

inline constexpr int kBlock = 16;  // pixels of a row
constexpr int blocks_along(int pixels) { return (pixels + kBlock - 1) / kBlock; }
// With one more on either side.
constexpr int corners_along(int pixels) { return blocks_along(pixels) + 3; }

inline constexpr int kDepthTerms = 7;
inline constexpr int kOtherTerms = 3;

// What codes mean along one ray, with x = code_px - centre.
struct alignas(64) Curve {
  std::array<float, kDepthTerms> per_z{};     // 1 / z in 1 / mm = sum of per_z[k] x^k
  std::array<float, kOtherTerms> other_px{};  // the other projector coordinate alike
  float length_squared = 0.0F;                // of the ray at z = 1
  std::array<float, 5> unused{};              // makes it one cache line
};
static_assert(sizeof(Curve) == 64);

// The curves of one image row, by block: at + t (slope + t bend) at its pixel t. Only the lowest two terms of the depth
// take their bend; those of the highest orders change so slowly that a block has one value, that of its middle.
struct CurveRow {
  const Curve *at = nullptr, *slope = nullptr, *bend = nullptr;
  float centre_px = 0.0F;
  float first_other_px = 0.0F, last_other_px = 0.0F;  // beyond these the projector lights nothing
};

// The curves of the row that lies the share `below` of the way between two rows of corners: kBlock pixels apart, from
// one beyond the image's left edge to one beyond those of its last block.
void curves_between(const Curve* up, const Curve* down, float below, int blocks, Curve* at, Curve* slope, Curve* bend);

// What depth_row() of axis_kernel.hpp gives, from curves. Room for whole blocks in depth_mm and sigma_mm. If `waiting`
// is not null, its points are written on the way: the memory takes them while the processor is busy with the depths.
void depth_row(const CurveRow& curves, const AxisInput& in, int count, float* depth_mm, float* sigma_mm,
               const PointRow* waiting = nullptr);

// One number of every corner of a row, alike: corners[k + 1] + t (slope[k] + t bend[k]) at pixel t of block k.
void parabolas_through(const float* corners, int blocks, float* slope, float* bend);

}  // namespace beltpick::range
