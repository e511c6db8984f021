// Which part lies where on the belt.
#pragma once

#include <vector>

#include "base/pose.hpp"
#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

// A part lying on the belt. The belt's origin is the middle of the camera's view.
struct BeltPart {
  int part = 0;  // index into the parts
  Pose<frame::Belt, frame::Part> T_belt_part;
};
using Scene = std::vector<BeltPart>;

}  // namespace beltpick::virtual_cell
