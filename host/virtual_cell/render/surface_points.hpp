// Points spread over a part's surface, for contact and footprint.
#pragma once

#include <vector>

#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

// In each cube of `spacing_mm` that the surface passes the point farthest from the centre of mass: what touches first.
// Part frame. Deterministic; also for meshes of few large triangles.
std::vector<Vec3> surface_points(const ScenePart& part, double spacing_mm);

}  // namespace beltpick::virtual_cell
