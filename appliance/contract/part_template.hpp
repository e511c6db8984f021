// What is taught of a part: its surface as points, its primitives, its symmetry, where to grip it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.hpp"
#include "base/stages.hpp"
#include "contract/gripper.hpp"
#include "contract/requirements.hpp"

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

// A cone of the part: a countersink, a chamfer, a tapered boss.
struct TaughtCone {
  Vec3 apex_mm = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  // unit: the way in which it widens
  double half_angle_rad = 0.0;
  double from_mm = 0.0;  // its surface lies from here ..
  double to_mm = 0.0;    // .. to here along the direction, from the apex
  bool concave = false;
  double surface_share = 0.0;  // of the part's
};

// How the part may come to rest on a level belt.
struct RestingPosition {
  Vec3 down = -Vec3::UnitZ();  // part frame, unit: towards the belt
  double height_mm = 0.0;      // of the centre of gravity above the belt
  double likelihood = 0.0;     // of this among all
};

// A search whose poses lie so far apart always has one from which ICP comes to the right place: measured on views of
// the part, every freedom off at once. 0: not measured.
struct SearchSteps {
  double turn_rad = 0.0;
  double shift_mm = 0.0;
};

// A way to recognise the part.
struct RecognitionRoute {
  int primitive = -1;    // from which the search starts; -1: from none, over all views
  double visible = 0.0;  // likelihood that a camera over the belt sees enough of it
  int poses = 0;         // that the search then tries, at the steps above
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
  // Not in every template: files of earlier versions lack them.
  std::vector<TaughtCone> cones;
  std::vector<RestingPosition> resting;  // most likely first
  std::vector<RecognitionRoute> routes;  // best first
  SearchSteps steps;
  std::optional<Requirements> requirements;  // of its poses; none: those of any part
};

}  // namespace beltpick
