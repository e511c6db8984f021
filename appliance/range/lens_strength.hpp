// Whether a projector's lens is so weak that depths come right after one step of Newton's method. Internal to range.
#pragma once

#include <span>

#include "range/axis_kernel.hpp"

namespace beltpick::range {

// Tries the codes 0 .. extent_px on a sample of camera rays, and compares with what four steps lead to. Without
// allocation.
bool one_step_suffices(AxisModel model, int extent_px, std::span<const float> ray_u, std::span<const float> ray_v);

}  // namespace beltpick::range
