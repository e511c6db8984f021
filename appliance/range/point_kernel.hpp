// What becomes of a row of depths: flying ones are taken out, the others become points. Internal to range.
#pragma once

#include <cstdint>

#include "base/stages.hpp"

namespace beltpick::range {

// One coordinate of a row's rays, by blocks of pixels: at[k] + t (slope[k] + t bend[k]) at pixel t of block k.
struct RayCurve {
  const float *at = nullptr, *slope = nullptr, *bend = nullptr;
};
// The rays (u, v, 1) of one image row: as curves, or, where these do not fit, one by one.
struct RayRow {
  RayCurve curve_u{}, curve_v{};
  const float *u = nullptr, *v = nullptr;  // null: the curves
};

struct RowCounts {
  int points = 0, flying = 0;
  int coded = 0;  // states that are valid
};

// Sets depths to 0 where `flies` is set, and valid states without a depth to kEdge there, else to kOrderUncertain: such
// a code is one that the geometry contradicts.
RowCounts settle_row(float* depth_mm, const std::uint8_t* flies, PixelState* state, int count);

// What write_points() reads and writes of one row.
struct PointRow {
  RayRow rays;
  const float *depth_mm = nullptr, *sigma_in_mm = nullptr;
  float *point_mm = nullptr, *sigma_mm = nullptr;
};
// point_mm = depth ray, and sigma_mm the sigma given; both 0 where the depth is. Both are written past the caches:
// stream_end() after the last row. What is read must have room for whole blocks.
void write_points(const PointRow& row, int count);

}  // namespace beltpick::range
