// What is taught of a part: its surface as points, its primitives, its symmetry, where to grip it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.hpp"
#include "base/stages.hpp"
#include "contract/gripper.hpp"

namespace beltpick {

// Turns of the part that leave its surface unchanged, within the tolerance it was taught with.
struct Symmetry {
  std::string name = "none";  // "none", "C2", "C4", "D2", ..., "revolution", "sphere": as result.json says it
  // Every non-trivial discrete element (part -> part); for a revolution the discrete ones beside it (the flip, if any).
  std::vector<Pose<frame::Part, frame::Part>> elements;
  bool revolution = false;  // any turn about the axis
  Vec3 axis_point_mm = Vec3::Zero();
  Vec3 axis_direction = Vec3::UnitZ();
};

// Where a gripper takes the part. Gripper frame: z is the way in (towards the part), x the closing direction.
struct Grasp {
  std::string name;
  Pose<frame::Part, frame::Gripper> T_part_gripper;
  double opening_mm = 0.0;  // between the jaws on the way in
};

struct PartTemplate {
  std::string name;             // the file's stem
  std::vector<Vec3f> point_mm;  // part frame, evenly spread over the surface
  std::vector<Vec3f> normal;    // outward, one a point
  double spacing_mm = 0.0;      // typical distance between neighbouring points
  Vec3 box_min_mm = Vec3::Zero();
  Vec3 box_max_mm = Vec3::Zero();
  std::vector<Primitive> primitives;  // best first: large, unique, leaving few freedoms
  Symmetry symmetry;
  std::vector<Grasp> grasps;            // in order of preference
  std::optional<GripperShape> gripper;  // that picks this part; none: the cell's
};

}  // namespace beltpick
