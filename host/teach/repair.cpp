#include <algorithm>
#include <set>

#include "teach/mesh_topology.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

namespace {

std::size_t remove_duplicates(Mesh& mesh) {
  std::vector<std::pair<Face, std::uint32_t>> corners;
  corners.reserve(mesh.face.size());
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    Face sorted = mesh.face[f];
    std::sort(sorted.begin(), sorted.end());
    corners.emplace_back(sorted, f);
  }
  std::sort(corners.begin(), corners.end());
  std::vector<bool> again(mesh.face.size(), false);
  for (std::size_t i = 1; i < corners.size(); ++i) again[corners[i].second] = corners[i].first == corners[i - 1].first;
  std::size_t f = 0;
  return std::erase_if(mesh.face, [&](const Face&) { return again[f++]; });
}

bool runs(const Face& face, std::uint32_t from, std::uint32_t to) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (face[k] == from && face[(k + 1) % 3] == to) return true;
  }
  return false;
}

double signed_volume(const Mesh& mesh, const Face& face) {
  const Vec3 a = mesh.vertex_mm[face[0]].cast<double>();
  return a.dot(mesh.vertex_mm[face[1]].cast<double>().cross(mesh.vertex_mm[face[2]].cast<double>())) / 6.0;
}

// The other side out. Edge 1 stays where it is, the others change places.
void flip(Mesh& mesh, Adjacency& adjacency, std::uint32_t f, std::vector<bool>& flipped) {
  std::swap(mesh.face[f][1], mesh.face[f][2]);
  std::swap(adjacency.beside[f][0], adjacency.beside[f][2]);
  flipped[f] = !flipped[f];
}

// Turns the shell that `start` belongs to so that its faces agree, then outward. Returns the faces it consists of.
std::vector<std::uint32_t> agree(Mesh& mesh, Adjacency& adjacency, std::uint32_t start, std::vector<bool>& visited,
                                 std::vector<bool>& flipped) {
  std::vector<std::uint32_t> shell{start};
  visited[start] = true;
  for (std::size_t at = 0; at < shell.size(); ++at) {
    const std::uint32_t f = shell[at];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.face[f][k];
      const std::uint32_t to = mesh.face[f][(k + 1) % 3];
      const std::uint32_t other = adjacency.beside[f][k];
      if (other >= Adjacency::kBranching || visited[other]) continue;  // at other edges nothing can be said
      visited[other] = true;
      if (runs(mesh.face[other], from, to)) flip(mesh, adjacency, other, flipped);
      shell.push_back(other);
    }
  }
  return shell;
}

void turn_outward(Mesh& mesh, Adjacency& adjacency, const std::vector<std::uint32_t>& shell,
                  std::vector<bool>& flipped) {
  double volume = 0;
  for (const std::uint32_t f : shell) volume += signed_volume(mesh, mesh.face[f]);
  if (volume >= 0) return;
  for (const std::uint32_t f : shell) flip(mesh, adjacency, f, flipped);
}

bool closed(const Adjacency& adjacency, const std::vector<std::uint32_t>& shell) {
  return std::all_of(shell.begin(), shell.end(), [&](std::uint32_t f) {
    const auto& beside = adjacency.beside[f];
    return std::find(beside.begin(), beside.end(), Adjacency::kOpen) == beside.end();
  });
}

// A shell inside another is a cavity when the modeller turned it inward: left as it is where it is one of several.
std::size_t make_orientation_consistent(Mesh& mesh, Adjacency& adjacency) {
  std::vector<bool> visited(mesh.face.size(), false);
  std::vector<bool> flipped(mesh.face.size(), false);
  std::vector<std::vector<std::uint32_t>> shells;
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    if (!visited[f]) shells.push_back(agree(mesh, adjacency, f, visited, flipped));
  }
  std::sort(shells.begin(), shells.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (s == 0 || !closed(adjacency, shells[s])) turn_outward(mesh, adjacency, shells[s], flipped);
  }
  return static_cast<std::size_t>(std::count(flipped.begin(), flipped.end(), true));
}

}  // namespace

MeshRepair repair(Mesh& mesh) {
  MeshRepair report;
  report.degenerate_faces = mesh.dropped_faces + weld(mesh);
  report.duplicate_faces = remove_duplicates(mesh);
  take_out_specks(mesh, report);
  if (mesh.face.empty()) return report;
  // Volumes are summed about the box's middle: an open shell's sign then tells inside from outside too.
  Vec3f low = mesh.vertex_mm.front();
  Vec3f high = low;
  for (const Vec3f& vertex : mesh.vertex_mm) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const Vec3f middle = 0.5F * (low + high);
  for (Vec3f& vertex : mesh.vertex_mm) vertex -= middle;
  Adjacency adjacency = adjacency_of(mesh);
  report.branching_edges = adjacency.branching_edges;
  report.flipped_faces = make_orientation_consistent(mesh, adjacency);
  for (Vec3f& vertex : mesh.vertex_mm) vertex += middle;
  measure_holes(mesh, adjacency, report);
  return report;
}

}  // namespace beltpick::teach
