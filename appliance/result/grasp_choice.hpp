// Which taught grasp can be reached: the gripper's jaws on their way in must be clear of everything measured.
#pragma once

#include <cstdint>
#include <span>

#include "contract/gripper.hpp"
#include "contract/part_model.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

using GripperPose = Pose<frame::Camera, frame::Gripper>;

enum class Reach : std::uint8_t { kReachable, kObstructed, kFromBelow };

// Whether the gripper can go in: from above the belt (60 degrees at most from its normal, or from the line of sight
// where there is no belt), its jaws clear of the belt and of what was measured.
Reach reach(const GraspPose& grasp, const PartPose& T_camera_part, const Scene& scene, const GripperShape& gripper);

struct GraspChoice {
  int index = -1;               // into model.grasps; -1: none can be reached
  bool any_obstructed = false;  // one would come from above, were it not for what stands in its way
};

// Whether the open jaws, in place, are clear of the part itself. A property of the part: asked once, when it is loaded.
bool clear_of_part(const GraspPose& grasp, std::span<const OrientedPoint> surface, const GripperShape& gripper);

// The first grasp that can be reached and is none of `refused`: those with which a pick at this place failed already.
GraspChoice choose_grasp(const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
                         const GripperShape& gripper, std::span<const GripperPose> refused = {});

}  // namespace beltpick::result
