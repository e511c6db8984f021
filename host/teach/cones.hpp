// Cones among a part's surface points: countersinks, chamfers round bores, tapered bosses.
#pragma once

#include <vector>

#include "contract/part_template.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

// The cones of what lies on no plane among `primitives`, largest first; none below 1 % of the surface, nor narrower
// than 5 or wider than 80 degrees from axis to side. By random triples of oriented points, whose tangent planes meet in
// the apex, and a least-squares fit to what then lies on the cone. Bands of a cone pass for cylinders and spheres:
// those are taken out of `primitives`, while a cone that is but a band of one of them is none. Deterministic.
std::vector<TaughtCone> find_cones(const Surface& surface, std::vector<Primitive>& primitives, std::uint64_t seed);

// Whether an oriented surface point lies on the cone.
bool on_cone(const TaughtCone& cone, const Vec3& point_mm, const Vec3& normal);

// Index of the first primitive that a surface point lies on, or -1.
int primitive_of(const std::vector<Primitive>& primitives, const Vec3& point_mm, const Vec3& normal);

}  // namespace beltpick::teach
