// Points of a block of pixels, for the kernels that write them. Internal to range's kernels.
#pragma once

#include <algorithm>

#include "range/lanes.hpp"
#include "range/point_kernel.hpp"
#include "range/stream_copy.hpp"

namespace beltpick::range {

using Order = int __attribute__((vector_size(kBlock * sizeof(int))));

[[gnu::always_inline]] inline Lanes ray_of(const RayCurve& curve, int block) {
  return curve.at[block] + kPixel * (curve.slope[block] + kPixel * curve.bend[block]);
}

// A block's points, laid out as x y z x y z ..
struct PointBlock {
  Lanes first, second, third;
};

[[gnu::always_inline]] inline PointBlock interleaved(const Lanes& x, const Lanes& y, const Lanes& z) {
  // x and y of the pixels of each third to their places, then z; elements from 16 on are the second vector's.
  constexpr Order kXy0 = {0, 16, 0, 1, 17, 0, 2, 18, 0, 3, 19, 0, 4, 20, 0, 5};
  constexpr Order kZ0 = {0, 1, 16, 3, 4, 17, 6, 7, 18, 9, 10, 19, 12, 13, 20, 15};
  constexpr Order kXy1 = {21, 0, 6, 22, 0, 7, 23, 0, 8, 24, 0, 9, 25, 0, 10, 26};
  constexpr Order kZ1 = {0, 21, 2, 3, 22, 5, 6, 23, 8, 9, 24, 11, 12, 25, 14, 15};
  constexpr Order kXy2 = {0, 11, 27, 0, 12, 28, 0, 13, 29, 0, 14, 30, 0, 15, 31, 0};
  constexpr Order kZ2 = {26, 1, 2, 27, 4, 5, 28, 7, 8, 29, 10, 11, 30, 13, 14, 31};
  return {__builtin_shuffle(__builtin_shuffle(x, y, kXy0), z, kZ0),
          __builtin_shuffle(__builtin_shuffle(x, y, kXy1), z, kZ1),
          __builtin_shuffle(__builtin_shuffle(x, y, kXy2), z, kZ2)};
}

// Those of pixels at .. at + kBlock - 1, of which the row has `count`.
[[gnu::always_inline]] inline void write_block(const PointRow& row, int at, int count) {
  const Lanes z = *loose(row.depth_mm + at);
  const bool one_by_one = row.rays.u != nullptr;
  const Lanes ray_u = one_by_one ? Lanes(*loose(row.rays.u + at)) : ray_of(row.rays.curve_u, at / kBlock);
  const Lanes ray_v = one_by_one ? Lanes(*loose(row.rays.v + at)) : ray_of(row.rays.curve_v, at / kBlock);
  const Lanes u = z > 0.0F ? ray_u : Lanes{};  // a pixel without a ray has NaN
  const Lanes v = z > 0.0F ? ray_v : Lanes{};
  const PointBlock points = interleaved(u * z, v * z, z);
  const Lanes sigma_mm = z > 0.0F ? Lanes(*loose(row.sigma_in_mm + at)) : Lanes{};
  if (at + kBlock <= count) {
    stream_block(points.first, row.point_mm + 3 * at);
    stream_block(points.second, row.point_mm + 3 * at + kBlock);
    stream_block(points.third, row.point_mm + 3 * at + 2 * kBlock);
    stream_block(sigma_mm, row.sigma_mm + at);
    return;
  }
  const auto pixels = static_cast<std::size_t>(count - at);
  std::memcpy(row.point_mm + 3 * at, &points, 3 * pixels * sizeof(float));
  std::memcpy(row.sigma_mm + at, &sigma_mm, pixels * sizeof(float));
}

}  // namespace beltpick::range
