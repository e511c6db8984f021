// Whether the virtual gripper's way in meets anything solid: its jaws' sweep against the true meshes and the belt.
#pragma once

#include <Eigen/Geometry>

#include "base/pose.hpp"
#include "contract/gripper.hpp"
#include "contract/mesh.hpp"

namespace beltpick::virtual_cell {

// One jaw's sweep, in the gripper's frame.
using JawSweep = Eigen::AlignedBox3d;

// The sweep of the jaw on side -1 or +1 of a gripper opened to `opening_mm`.
JawSweep jaw_sweep(const GripperShape& shape, double opening_mm, int side);

// Whether a triangle of the mesh meets the box (separating axes: Akenine-Moeller 2001).
bool sweep_meets_mesh(const JawSweep& sweep, const Mesh& mesh, const Pose<frame::Gripper, frame::Part>& T_gripper_part);

// Whether a corner of the box lies below the belt (z < 0 of its frame).
bool sweep_meets_belt(const JawSweep& sweep, const Pose<frame::Belt, frame::Gripper>& T_belt_gripper);

}  // namespace beltpick::virtual_cell
