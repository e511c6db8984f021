// Grasps for a part whose user taught none: places where parallel jaws can close on it.
#pragma once

#include <vector>

#include "contract/part_template.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

// Grasps at the middle of the part and of its bosses, from the six directions of its box and from eight around each
// boss, narrowest opening first. None wider than `opening_max_mm`.
std::vector<Grasp> default_grasps(const Surface& surface, const std::vector<Primitive>& primitives,
                                  double opening_max_mm);

}  // namespace beltpick::teach
