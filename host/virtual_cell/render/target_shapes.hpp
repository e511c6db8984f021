// Bodies of exactly known shape, painted matt white: balls and blocks.
#pragma once

#include <string>

#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

// A ball about the origin: facets so fine (a refined icosahedron) and so scaled that their mean distance from the
// centre is the radius and none strays from it by over 1e-4 of it.
Result<ScenePart> make_ball(std::string name, double radius_mm);

// A block of size_mm that stands on z = 0, centred in x and y.
Result<ScenePart> make_block(std::string name, const Vec3& size_mm);

}  // namespace beltpick::virtual_cell
