// What every peer gets of one object, and what it answers.
#pragma once

#include <vector>

#include "base/stages.hpp"
#include "contract/part_template.hpp"

namespace beltpick::bench {

using PartPose = Pose<frame::Camera, frame::Part>;

struct PeerObject {
  std::vector<OrientedPoint> sample;  // of the object's measured points, camera frame
  std::vector<PartPose> starts;       // for what needs one, best first
  const PartTemplate* part = nullptr;
};

// A peer's answer from one start, and how well it says that it fits (less is better).
struct PeerFit {
  PartPose T_camera_part;
  double distance = 1e9;
};

}  // namespace beltpick::bench
