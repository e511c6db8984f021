// Thinning: of a template's points fewer that still lie all over its surface.
#pragma once

#include <cstddef>
#include <span>

#include "base/point_block.hpp"
#include "base/stages.hpp"

namespace beltpick::pipeline {

// Copies, in their order, points (part frame) of which no two on the same side of the surface lie within `apart_mm` of
// each other; every point left out lies that near to one copied. They are chosen at random: row by row the gaps between
// them would form rows, too. Returns how many, at most out.size() blocks of them. Same input, same points.
std::size_t thin_surface(std::span<const OrientedPoint> surface, float apart_mm, std::span<PointBlock> out);

}  // namespace beltpick::pipeline
