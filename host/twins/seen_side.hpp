// What a far camera sees of a part from one side.
#pragma once

#include <vector>

#include "contract/part_model.hpp"

namespace beltpick::twins {

using PartPose = Pose<frame::Camera, frame::Part>;

// A pose in which the camera looks along `sight` (unit, part frame, away from the camera) at a part so far away that
// the rays are as good as parallel.
PartPose look_along(const PartModel& model, const Vec3& sight);

// The surface points in sight, camera frame, in the order of the model's surface. Surfaces that lean away by more than
// 75 degrees are left out: they are hardly measured.
std::vector<OrientedPoint> seen_side(const PartModel& model, const PartPose& T_camera_part);

// The area of what is seen that does not lie on the part in that pose, mm^2, and at most `enough_mm2`. A point lies on
// it within `tolerance_mm` of the surface. `spacing_mm` is that of the points.
double area_off_mm2(const std::vector<OrientedPoint>& seen, double spacing_mm, const PartModel& part,
                    const PartPose& T_camera_part, double tolerance_mm, double enough_mm2);

}  // namespace beltpick::twins
