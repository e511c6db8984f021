// How one part's whole surface fits that of another, in the pose in which they fit best.
#pragma once

#include <span>
#include <vector>

#include "contract/part_model.hpp"

namespace beltpick::twins {

struct WholeFit {
  double differing_share = 1.0;                  // of the points: farther than the tolerance off the other's surface
  double largest_mm = 0.0;                       // distance of a point to the other's surface
  Vec3 where_mm = Vec3::Zero();                  // the point that lies farthest off, in its own frame
  Pose<frame::Camera, frame::Part> T_own_other;  // the other part's frame to that of the points
};

// Tries 3888 rotations with the surfaces' centres on each other, aligns the best and takes the one that differs least.
// `points`: evenly spread over the surface.
WholeFit fit_whole(std::span<const OrientedPoint> points, const PartModel& other, double tolerance_mm);

// The mirror image of the points.
std::vector<OrientedPoint> mirrored(std::span<const OrientedPoint> points);

}  // namespace beltpick::twins
