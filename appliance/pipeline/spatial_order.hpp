// The order in which points lie close together in memory that lie close together in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.hpp"

namespace beltpick::pipeline {

// The indices of the points along Morton's curve (the bits of their three coordinates in turn), at a thousandth of the
// box's longest side: most neighbours on it are neighbours in space. What is drawn or looked up one after another then
// lies in the nearest cache.
std::vector<std::uint32_t> spatial_order(std::span<const Vec3f> point_mm);

}  // namespace beltpick::pipeline
