// The poses in which a rigid part can lie on a flat belt.
#pragma once

#include <vector>

#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

struct RestingPose {
  Mat3 R_belt_part = Mat3::Identity();  // one turn of the part about the vertical among all
  double height_mm = 0.0;               // of the centre of mass above the belt
  double weight = 0.0;                  // share of all first orientations that roll into this one
};

// Stable poses by the height of the centre of mass as a function of the direction that points down: its local minima
// are the resting poses, the directions that descend into one are its weight (the solid angle). Minima so shallow that
// a nudge of `nudge_mm` leaves them are merged into what lies beyond. Heaviest first.
std::vector<RestingPose> resting_poses(const ScenePart& part, double nudge_mm = 0.3);

}  // namespace beltpick::virtual_cell
