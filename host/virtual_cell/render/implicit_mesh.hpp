// Turns a solid given by a signed distance function into a watertight triangle mesh.
#pragma once

#include <functional>

#include <Eigen/Geometry>

#include "base/pose.hpp"
#include "contract/mesh.hpp"

namespace beltpick::virtual_cell {

// Negative inside, positive outside, about the distance in mm near the surface.
using SignedDistance = std::function<double(const Vec3& point_mm)>;

// Surface nets (Gibson 1998): one vertex in each cell that the surface crosses, here moved onto the surface itself, one
// quadrilateral across each crossed edge of the grid. Faces are counter-clockwise seen from outside. `box` must enclose
// the solid; `cell_mm` is the grid's step and about the length of the triangles' sides.
Mesh mesh_of_solid(const SignedDistance& solid, const Eigen::AlignedBox3d& box, double cell_mm);

}  // namespace beltpick::virtual_cell
