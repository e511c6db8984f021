// Q(P, M): how well a sample of an object lies on a part in an assumed pose: the paper's equation (6).
#pragma once

#include <span>

#include "base/pose.hpp"
#include "contract/part_model.hpp"

namespace beltpick::search {

using PartPose = Pose<frame::Camera, frame::Part>;

// The mean over the sample of the distance to the nearest point of the part, in mm, each distance capped at `cap_mm` so
// that points of something else do not decide; a point whose nearest surface faces the other way counts as capped.
// `sample`: camera frame. Gives up, returning more than `give_up_mm`, once the mean is sure to exceed that.
float mean_distance_mm(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& T_camera_part,
                       float cap_mm, float give_up_mm);

}  // namespace beltpick::search
