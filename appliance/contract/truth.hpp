// What the virtual cell knows of a scene it rendered: truth.json.
#pragma once

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

struct Truth {
  std::vector<TruePart> parts;
  std::string xyz_file = "truth_xyz.npy";              // float32 height x width x 3, camera frame, mm
  std::string instances_file = "truth_instances.npy";  // uint16 height x width: 0 none, i the part of index i - 1
};

}  // namespace beltpick
