// How much of each part the camera sees, against what it would see of the part alone in an image large enough.
#pragma once

#include <vector>

#include "virtual_cell/render/ray_scene.hpp"
#include "virtual_cell/render/rig.hpp"

namespace beltpick::virtual_cell {

// One share in [0, 1] for each placed instance.
std::vector<double> visible_fractions(const Rig& rig, const RayScene& scene);

}  // namespace beltpick::virtual_cell
