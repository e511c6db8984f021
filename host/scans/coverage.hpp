// Which sides of the part no scan has seen.
#pragma once

#include <string>
#include <vector>

#include "contract/mesh.hpp"

namespace beltpick::scans {

// The part as seen along one direction.
struct Side {
  std::string name;              // "top", "underside", ..., "+x +y": of the part frame
  Vec3 towards = Vec3::UnitZ();  // from the part to whoever looks, part frame
  double missing_share = 0.0;    // of what should be seen: there only the inside of the far surface shows
};

// 26 sides: along the axes, between two, between three; those with most missing first. `surface`: points with outward
// normals. `spacing_mm`: between them.
std::vector<Side> find_missing(const Mesh& surface, double spacing_mm);

}  // namespace beltpick::scans
