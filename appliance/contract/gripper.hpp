// The room that a parallel gripper takes on its way in: what a grasp must have free, and what the virtual robot has.
#pragma once

namespace beltpick {

// Two jaws and the palm that carries them, as boxes in the gripper's frame (z the way in, x the closing direction,
// origin between the fingertips). Open, each jaw reaches from +-opening/2 outwards in x, is centred in y, and extends
// from its tip backwards in z. The palm is centred in x and y and begins `jaw_depth_mm` behind the tips. On the way in
// each sweeps everything behind it, so the sweep is the same box without end.
struct GripperShape {
  double jaw_thickness_mm = 8.0;  // along x
  double jaw_width_mm = 16.0;     // along y
  double tip_mm = 3.0;            // the tips reach this far beyond the grasp's origin along z
  double reach_mm = 200.0;        // how far behind the tips the way in is looked at
  double jaw_depth_mm = 80.0;     // of the jaws, from the palm to the tips
  double palm_length_mm = 100.0;  // along x; 0: no palm
  double palm_width_mm = 50.0;    // along y

  friend bool operator==(const GripperShape&, const GripperShape&) = default;
};

}  // namespace beltpick
