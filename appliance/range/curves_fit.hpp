// Whether depths from curves are as good as those from the lens model itself. Internal to range.
#pragma once

#include <span>

#include "range/axis_kernel.hpp"
#include "range/depth_curves.hpp"

namespace beltpick::range {

// Tries codes over the whole projector on a sample of image rows, and compares with what depth_row() of the model gives
// for the same rays (by rows of `cols` pixels). False where a depth is off by what some thousandths of a projector
// pixel are worth, or a ray has none, as with wide-angle lenses or few pixels. Without allocation.
bool curves_fit(const AxisModel& model, int extent_px, DepthCurves& curves, std::span<const float> ray_u,
                std::span<const float> ray_v, int cols);

}  // namespace beltpick::range
