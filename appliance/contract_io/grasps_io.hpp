// grasps.toml: where a gripper takes a part, in the mesh's own coordinates (scaled to mm):
//   [[grasp]]
//   name = "boss"
//   position_mm = [0, 0, 10]   # between the finger tips when closed
//   approach = [0, 0, -1]      # the way in
//   closing = [1, 0, 0]        # the jaws close along this direction
//   opening_mm = 40            # between the jaws on the way in
// and, where this part's gripper is not the cell's, its room (contract/gripper.hpp); what is left out has its default:
//   [gripper]
//   jaw_thickness_mm = 8       # along the closing direction
//   jaw_width_mm = 16          # across it
//   jaw_depth_mm = 80          # from the palm to the tips
//   tip_mm = 3                 # the tips reach beyond position_mm by
//   palm_length_mm = 100       # along the closing direction; 0: no palm
//   palm_width_mm = 50         # across it
//   reach_mm = 200             # the way in is looked at so far behind the tips
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "base/result.hpp"
#include "contract/part_template.hpp"

namespace beltpick::contract_io {

// Reads the grasps in the order of preference in which they stand. The closing direction is made square to the
// approach. Errors: kFileNotFound, kFormatInvalid, kMemberMissing, kValueOutOfRange.
Result<std::vector<Grasp>> read_grasps(const std::filesystem::path& path);

// The gripper that the file describes; nothing where it has no [gripper]. Errors: kFileNotFound, kFormatInvalid,
// kValueOutOfRange; kUsage for a member that is none of them.
Result<std::optional<GripperShape>> read_gripper(const std::filesystem::path& path);

// The members of [gripper], as files call them.
struct GripperMember {
  const char* name;
  double GripperShape::*value;
};
std::span<const GripperMember> gripper_members();

// Whether the shape is one: finite, no member negative, jaws that have a size. Null, or what is expected.
const char* gripper_fault(const GripperShape& gripper);

// The gripper's frame from its way in (z) and closing direction (x): both unit vectors after being made square.
// `closing` must not be parallel to `approach`.
Pose<frame::Part, frame::Gripper> gripper_pose(const Vec3& position_mm, const Vec3& approach, const Vec3& closing);

}  // namespace beltpick::contract_io
