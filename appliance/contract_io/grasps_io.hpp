// grasps.toml: where a gripper takes a part, in the mesh's own coordinates (scaled to mm):
//   [[grasp]]
//   name = "boss"
//   position_mm = [0, 0, 10]   # between the finger tips when closed
//   approach = [0, 0, -1]      # the way in
//   closing = [1, 0, 0]        # the jaws close along this direction
//   opening_mm = 40            # between the jaws on the way in
#pragma once

#include <filesystem>
#include <vector>

#include "base/result.hpp"
#include "contract/part_template.hpp"

namespace beltpick::contract_io {

// Reads the grasps in the order of preference in which they stand. The closing direction is made square to the
// approach. Errors: kFileNotFound, kFormatInvalid, kMemberMissing, kValueOutOfRange.
Result<std::vector<Grasp>> read_grasps(const std::filesystem::path& path);

// The gripper's frame from its way in (z) and closing direction (x): both unit vectors after being made square.
// `closing` must not be parallel to `approach`.
Pose<frame::Part, frame::Gripper> gripper_pose(const Vec3& position_mm, const Vec3& approach, const Vec3& closing);

}  // namespace beltpick::contract_io
