// A surface as a modeller or a scanner gives it: triangles, or bare points where there are no faces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/pose.hpp"

namespace beltpick {

struct Mesh {
  std::vector<Vec3f> vertex_mm;      // part frame
  std::vector<Vec3f> vertex_normal;  // empty, or one a vertex (scans carry them)
  std::vector<std::array<std::uint32_t, 3>>
      face;                       // indices of vertices, counter-clockwise seen from outside; empty for a scan
  std::size_t dropped_faces = 0;  // faces of the file without an area: they are not among `face`
};

}  // namespace beltpick
