// Neighbourhoods of an object's sample: what lies close together belongs to one part, even where parts were not parted.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "base/stages.hpp"

namespace beltpick::pipeline {

// The point that lies highest above the belt, or nearest to the camera without one; camera frame, mm. `sample` holds
// at least one point.
Vec3f highest_point_mm(std::span<const OrientedPoint> sample, const std::optional<Plane>& belt);

struct Neighbourhood {
  std::size_t count = 0;  // points within the radius
  Vec3f farthest_mm;      // of the whole sample, from the centre
};

// Moves the points of `sample` within `radius_mm` of the centre to its front. The same input gives the same order.
// `sample` holds at least one point.
Neighbourhood gather_round(std::span<OrientedPoint> sample, const Vec3f& centre_mm, float radius_mm);

}  // namespace beltpick::pipeline
