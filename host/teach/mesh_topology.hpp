// How a mesh hangs together: which vertices are one, which faces meet at an edge, which pieces and holes there are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "contract/mesh.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

using Face = std::array<std::uint32_t, 3>;

// What lies beyond each edge of each face; edge k goes from corner k to the next.
struct Adjacency {
  static constexpr std::uint32_t kOpen = 0xFFFFFFFFU;       // nothing
  static constexpr std::uint32_t kBranching = 0xFFFFFFFEU;  // more than one face
  std::vector<std::array<std::uint32_t, 3>> beside;
  std::size_t branching_edges = 0;
};

// Makes vertices one that lie within some millionths of the mesh's size of each other: modellers split them at
// sharp edges and texture seams, and round them in text. Returns how many faces collapsed by that and were removed.
std::size_t weld(Mesh& mesh);

Adjacency adjacency_of(const Mesh& mesh);

// Counts the bodies, and takes out those that hold next to none of the surface and lie apart from the main one: what a
// modeller left behind would stretch the part's box. Fills specks and pieces.
void take_out_specks(Mesh& mesh, MeshRepair& report);

// Fills open_edges, holes and hole_share.
void measure_holes(const Mesh& mesh, const Adjacency& adjacency, MeshRepair& report);

}  // namespace beltpick::teach
