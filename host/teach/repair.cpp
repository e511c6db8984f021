#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <unordered_map>

#include "teach/surface.hpp"

namespace beltpick::teach {

namespace {

using Face = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

struct PlaceHash {
  std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
    return (bits[0] * 73856093ULL) ^ (bits[1] * 19349663ULL) ^ (bits[2] * 83492791ULL);
  }
};

// Modellers split vertices at sharp edges and texture seams; neighbours are found only when equal places are one
// vertex.
void weld(Mesh& mesh) {
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, PlaceHash> first;
  std::vector<std::uint32_t> welded(mesh.vertex_mm.size());
  for (std::uint32_t i = 0; i < mesh.vertex_mm.size(); ++i) {
    const Vec3f place = mesh.vertex_mm[i] + Vec3f::Zero();
    std::array<std::uint32_t, 3> bits{};
    std::memcpy(bits.data(), place.data(), sizeof bits);
    welded[i] = first.try_emplace(bits, i).first->second;
  }
  for (Face& face : mesh.face) {
    for (std::uint32_t& index : face) index = welded[index];
  }
  std::erase_if(mesh.face, [](const Face& f) { return f[0] == f[1] || f[1] == f[2] || f[0] == f[2]; });
}

std::size_t remove_duplicates(Mesh& mesh) {
  std::set<Face> seen;
  const std::size_t before = mesh.face.size();
  std::erase_if(mesh.face, [&](Face face) {
    std::sort(face.begin(), face.end());
    return !seen.insert(face).second;
  });
  return before - mesh.face.size();
}

// The faces at each edge, the edge as (smaller, larger) vertex.
using EdgeFaces = std::map<Edge, std::vector<std::uint32_t>>;

EdgeFaces faces_of_edges(const Mesh& mesh) {
  EdgeFaces edges;
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) edges[std::minmax(mesh.face[f][k], mesh.face[f][(k + 1) % 3])].push_back(f);
  }
  return edges;
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

// Turns the shell that `start` belongs to so that its faces agree, then outward. Returns the faces it consists of.
std::vector<std::uint32_t> agree(Mesh& mesh, const EdgeFaces& edges, std::uint32_t start, std::vector<bool>& visited,
                                 std::vector<bool>& flipped) {
  std::vector<std::uint32_t> shell{start};
  visited[start] = true;
  for (std::size_t at = 0; at < shell.size(); ++at) {
    const std::uint32_t f = shell[at];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.face[f][k];
      const std::uint32_t to = mesh.face[f][(k + 1) % 3];
      const auto& neighbours = edges.at(std::minmax(from, to));
      if (neighbours.size() != 2) continue;  // at an open or branching edge nothing can be said
      const std::uint32_t other = neighbours[0] == f ? neighbours[1] : neighbours[0];
      if (visited[other]) continue;
      visited[other] = true;
      if (runs(mesh.face[other], from, to)) {
        std::swap(mesh.face[other][1], mesh.face[other][2]);
        flipped[other] = !flipped[other];
      }
      shell.push_back(other);
    }
  }
  return shell;
}

void turn_outward(Mesh& mesh, const std::vector<std::uint32_t>& shell, std::vector<bool>& flipped) {
  double volume = 0;
  for (const std::uint32_t f : shell) volume += signed_volume(mesh, mesh.face[f]);
  if (volume >= 0) return;
  for (const std::uint32_t f : shell) {
    std::swap(mesh.face[f][1], mesh.face[f][2]);
    flipped[f] = !flipped[f];
  }
}

bool closed(const Mesh& mesh, const EdgeFaces& edges, const std::vector<std::uint32_t>& shell) {
  return std::all_of(shell.begin(), shell.end(), [&](std::uint32_t f) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (edges.at(std::minmax(mesh.face[f][k], mesh.face[f][(k + 1) % 3])).size() < 2) return false;
    }
    return true;
  });
}

// A shell inside another is a cavity when the modeller turned it inward: left as it is where it is one of several.
std::size_t make_orientation_consistent(Mesh& mesh, const EdgeFaces& edges) {
  std::vector<bool> visited(mesh.face.size(), false);
  std::vector<bool> flipped(mesh.face.size(), false);
  std::vector<std::vector<std::uint32_t>> shells;
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    if (!visited[f]) shells.push_back(agree(mesh, edges, f, visited, flipped));
  }
  std::sort(shells.begin(), shells.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (s == 0 || !closed(mesh, edges, shells[s])) turn_outward(mesh, shells[s], flipped);
  }
  return static_cast<std::size_t>(std::count(flipped.begin(), flipped.end(), true));
}

}  // namespace

MeshRepair repair(Mesh& mesh) {
  MeshRepair report;
  weld(mesh);
  report.duplicate_faces = remove_duplicates(mesh);
  // Volumes are summed about the box's middle: an open shell's sign then tells inside from outside too.
  Vec3f low = mesh.vertex_mm.front();
  Vec3f high = low;
  for (const Vec3f& vertex : mesh.vertex_mm) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const Vec3f middle = 0.5F * (low + high);
  for (Vec3f& vertex : mesh.vertex_mm) vertex -= middle;
  const EdgeFaces edges = faces_of_edges(mesh);
  report.flipped_faces = make_orientation_consistent(mesh, edges);
  report.open_edges = static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second.size() == 1; }));
  for (Vec3f& vertex : mesh.vertex_mm) vertex += middle;
  return report;
}

}  // namespace beltpick::teach
