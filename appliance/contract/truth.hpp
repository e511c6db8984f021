// What the virtual cell knows of a scene it rendered: truth.json.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/pose.hpp"

namespace beltpick {

struct TruePart {
  std::string part;  // the template's name
  Pose<frame::Camera, frame::Part> T_camera_part;
  // Share of the pixels that the part would show alone, in an image large enough, that are in view and not hidden.
  double visible_fraction = 0.0;
  std::vector<Pose<frame::Part, frame::Part>> symmetries;  // non-trivial turns that map the part onto itself
};

// The calibration plate of a scene. Its frame is the part "plate"'s: origin at the first inner corner, x along the
// columns, y along the rows, z into the plate: from the front the print is seen with x to the right and y down.
struct TruePlate {
  int columns = 0, rows = 0;  // inner corners
  double square_mm = 0.0;
  bool charuco = false;
  double width_mm = 0.0, height_mm = 0.0, thickness_mm = 0.0;  // of the whole plate
  double bend_mm = 0.0;                                        // from the highest to the lowest place of the face
  Pose<frame::Camera, frame::Part> T_camera_plate;
  // Of each inner corner, row by row: its place on the bent face, and where camera and projector have it.
  std::vector<Vec3> corner_plate_mm;
  std::vector<Eigen::Vector2d> corner_camera_px, corner_projector_px;
};

// A surface of known shape; all lengths in the camera frame, mm.
struct TrueTarget {
  enum class Kind { kPlane, kSphere } kind = Kind::kPlane;
  int instance = 0;                     // its number in the instances' image
  Vec3 point_camera_mm = Vec3::Zero();  // the sphere's centre, or a point of the plane
  Vec3 normal_camera = Vec3::Zero();    // of a plane, unit, towards the camera
  double radius_mm = 0.0;               // of a sphere
  double height_mm = 0.0;               // of a step's plane above the wedge's base
};

struct Truth {
  std::vector<TruePart> parts;
  std::optional<TruePlate> plate;
  std::vector<TrueTarget> targets;
  std::string xyz_file = "truth_xyz.npy";              // float32 height x width x 3, camera frame, mm
  std::string instances_file = "truth_instances.npy";  // uint16 height x width: 0 none, i the part of index i - 1
};

}  // namespace beltpick
