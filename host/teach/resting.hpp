// How a part comes to rest on a level belt: the faces of its convex hull that its centre of gravity stands over.
#pragma once

#include <vector>

#include "contract/mesh.hpp"
#include "contract/part_template.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

// Of the volume where the mesh encloses one (uniform density), else of the surface. Part frame, mm.
Vec3 centre_of_gravity_mm(const Mesh& mesh, const Surface& surface);

// `surface_mm`: corners of the mesh, or points spread over the surface. The positions in which a part dropped in any
// orientation ends, most likely first: it falls towards the face of its hull under its centre of gravity and tips over
// that face's edges until one holds it. The likelihood is the solid angle of orientations that end there; beyond the
// first dozen, positions below 1 % are left out.
std::vector<RestingPosition> resting_positions(const std::vector<Vec3f>& surface_mm, const Vec3& centre_of_gravity_mm,
                                               const Symmetry& symmetry);

}  // namespace beltpick::teach
