// The shapes of the virtual cell's parts as signed distance functions: castings with cylinders that are true cylinders.
#pragma once

#include <Eigen/Geometry>

#include "virtual_cell/render/implicit_mesh.hpp"

namespace beltpick::virtual_cell {

// A steel casting of a car, about 174 x 103 x 58 mm: a boss with a blind bore (axis y, radius kKnuckleBossRadiusMm), an
// arm to an eye with a bore (axis z), an ear with a hole, a rib and a foot. No symmetry.
double knuckle_distance(const Vec3& point_mm);
Eigen::AlignedBox3d knuckle_box();
inline constexpr double kKnuckleBossRadiusMm = 26.0;
inline constexpr double kKnuckleBoreRadiusMm = 15.0;

// A quarter bend of pipe with two equal flanges of four holes; half a turn about the bisector maps it onto itself.
double elbow_distance(const Vec3& point_mm);
Eigen::AlignedBox3d elbow_box();

// An angle bracket with a round post, a gusset and two unlike holes. No symmetry.
double bracket_distance(const Vec3& point_mm);
Eigen::AlignedBox3d bracket_box();

// A steel block with a right-angled groove across it and a deep pocket: concave, for light that surfaces throw on each
// other. No symmetry.
double vblock_distance(const Vec3& point_mm);
Eigen::AlignedBox3d vblock_box();

// A tie rod's end: the housing of a ball joint with its tapered stud (axis z) and a shank with a bore (axis x). A
// mirror leaves it as it is (y -> -y); no turn does.
double balljoint_distance(const Vec3& point_mm);
Eigen::AlignedBox3d balljoint_box();

// A stamped and bent sheet of 2.5 mm: base, flange and tab, a cut corner, two unlike holes and a slot. No symmetry.
double sheet_distance(const Vec3& point_mm);
Eigen::AlignedBox3d sheet_box();

}  // namespace beltpick::virtual_cell
