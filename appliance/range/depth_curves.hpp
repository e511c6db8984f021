// DepthCurves: along a camera ray, what a code means in depth, as curves worked out ahead. Internal to range.
//
// For a given ray, 1 / z is nearly a straight line in the projector coordinate; the lenses bend it a little, and the
// next pixel's curve differs a little. So curves stand at the corners of blocks of pixels, and those between are
// interpolated. That spares the search for where the ray's image meets the code, pixel by pixel (axis_kernel.hpp),
// where the lenses allow it: see curves_fit.hpp.
#pragma once

#include <span>

#include "base/arena.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "range/curve_kernel.hpp"

namespace beltpick::range {

class DepthCurves {
 public:
  // Room for cameras of up to rows x cols.
  DepthCurves(Arena& arena, int rows, int cols);

  // Works the curves out. Takes some hundredths of a second.
  void load(const Calibration& calibration, Axis axis);

  // Good until the next call.
  const CurveRow& row(int row);

 private:
  std::span<Curve> corners_;  // by rows, kRowsApart apart
  std::span<Curve> at_, slope_, bend_;
  int across_ = 0;  // corners
  CurveRow row_;
};

}  // namespace beltpick::range
