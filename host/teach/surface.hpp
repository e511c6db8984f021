// A part's surface as evenly spread points with outward normals: what a template is made of.
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.hpp"
#include "contract/mesh.hpp"

namespace beltpick::teach {

struct Surface {
  std::vector<Vec3f> point_mm;  // part frame
  std::vector<Vec3f> normal;    // outward, unit
  double spacing_mm = 0.0;      // typical distance between neighbours
  double area_mm2 = 0.0;
};

// What was found wrong with a mesh and mended, or could not be.
struct MeshRepair {
  std::size_t degenerate_faces = 0;  // without an area, also after equal corners became one
  std::size_t duplicate_faces = 0;
  std::size_t flipped_faces = 0;
  std::size_t branching_edges = 0;  // of more than two faces: walls inside, or bodies that touch
  std::size_t open_edges = 0;       // of only one face: a hole, or a surface without thickness
  std::size_t holes = 0;            // loops of open edges with an area
  double hole_share = 0.0;          // their area, of that of the surface
  std::size_t specks = 0;           // pieces far smaller than the part and apart from it: taken out
  std::size_t pieces = 1;           // bodies whose boxes do not meet
};

// Welds vertices that are equal but for rounding, removes duplicate faces and specks and turns the faces so that
// neighbours agree and closed shells look outward. The mesh must have faces; it has none left where none had an area.
MeshRepair repair(Mesh& mesh);

// Spreads `count` points evenly over the faces of a repaired mesh by dart throwing: no two points with like normals lie
// closer than about three quarters of the mean distance. Deterministic. Errors: kMeshInvalid when the surface has no
// area.
Result<Surface> sample_mesh(const Mesh& mesh, std::size_t count, std::uint64_t seed);

// Thins a scan to at most `count` evenly spread points; normals are taken from the scan or fitted to each point's
// neighbours and turned away from the scan's centre. Errors: kMeshInvalid with fewer than 100 points.
Result<Surface> sample_scan(const Mesh& scan, std::size_t count, std::uint64_t seed);

}  // namespace beltpick::teach
