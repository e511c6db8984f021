#include "teach/mesh_topology.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include <Eigen/Geometry>

namespace beltpick::teach {

namespace {

constexpr double kWeldShare = 3e-6;    // of the box's diagonal
constexpr double kSpeckShare = 1e-3;   // of the surface
constexpr double kSpecksShare = 0.01;  // of the surface, all of them: more is a mesh of loose faces
constexpr double kHoleShare = 1e-6;    // of the surface: less is a seam of edges that lie on each other

using Box = Eigen::AlignedBox3f;

// Sets of vertices that grow together.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

// The first vertex of each place. A place is looked for in every cell that reaches into its neighbourhood: mostly one.
class Places {
 public:
  explicit Places(double tolerance_mm) : tolerance_mm_(tolerance_mm), cell_mm_(4 * tolerance_mm) {}

  std::uint32_t first_at(const std::vector<Vec3f>& vertices, std::uint32_t index) {
    const Vec3 at = vertices[index].cast<double>();
    const Cell low = cell_of(at - Vec3::Constant(tolerance_mm_));
    const Cell high = cell_of(at + Vec3::Constant(tolerance_mm_));
    for (long x = low[0]; x <= high[0]; ++x) {
      for (long y = low[1]; y <= high[1]; ++y) {
        for (long z = low[2]; z <= high[2]; ++z) {
          const auto [from, to] = cells_.equal_range(hash({x, y, z}));
          for (auto other = from; other != to; ++other) {
            if ((vertices[other->second].cast<double>() - at).norm() <= tolerance_mm_) return other->second;
          }
        }
      }
    }
    cells_.emplace(hash(cell_of(at)), index);
    return index;
  }

 private:
  using Cell = std::array<long, 3>;

  [[nodiscard]] Cell cell_of(const Vec3& at) const {
    return {std::lround(std::floor(at.x() / cell_mm_)), std::lround(std::floor(at.y() / cell_mm_)),
            std::lround(std::floor(at.z() / cell_mm_))};
  }
  static std::size_t hash(const Cell& cell) {
    return (static_cast<std::size_t>(cell[0]) * 73856093ULL) ^ (static_cast<std::size_t>(cell[1]) * 19349663ULL) ^
           (static_cast<std::size_t>(cell[2]) * 83492791ULL);
  }

  double tolerance_mm_;
  double cell_mm_;
  std::unordered_multimap<std::size_t, std::uint32_t> cells_;
};

double area_mm2(const Mesh& mesh, const Face& face) {
  const Vec3 a = (mesh.vertex_mm[face[1]] - mesh.vertex_mm[face[0]]).cast<double>();
  const Vec3 b = (mesh.vertex_mm[face[2]] - mesh.vertex_mm[face[0]]).cast<double>();
  return 0.5 * a.cross(b).norm();
}

struct Piece {
  double area_mm2 = 0.0;
  Box box;
};

std::map<std::uint32_t, Piece> pieces_of(const Mesh& mesh, Groups& groups) {
  std::map<std::uint32_t, Piece> pieces;
  for (const Face& face : mesh.face) {
    Piece& piece = pieces[groups.of(face[0])];
    piece.area_mm2 += area_mm2(mesh, face);
    for (const std::uint32_t index : face) piece.box.extend(mesh.vertex_mm[index]);
  }
  return pieces;
}

// Bodies whose boxes meet are taken for one: a screw in its hole, a cavity in its casting.
std::size_t bodies_apart(const std::vector<Piece>& pieces) {
  Groups groups(pieces.size());
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    for (std::uint32_t j = 0; j < i; ++j) {
      if (pieces[i].box.intersects(pieces[j].box)) groups.join(i, j);
    }
  }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) count += groups.of(i) == i ? 1U : 0U;
  return count;
}

std::vector<std::array<std::uint32_t, 2>> open_edges(const Mesh& mesh, const Adjacency& adjacency) {
  std::vector<std::array<std::uint32_t, 2>> open;
  for (std::size_t f = 0; f < mesh.face.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (adjacency.beside[f][k] == Adjacency::kOpen) open.push_back({mesh.face[f][k], mesh.face[f][(k + 1) % 3]});
    }
  }
  return open;
}

}  // namespace

std::size_t weld(Mesh& mesh) {
  Box box;
  for (const Vec3f& vertex : mesh.vertex_mm) box.extend(vertex);
  Places places(std::max(kWeldShare * static_cast<double>(box.diagonal().norm()), 1e-35));
  std::vector<std::uint32_t> first(mesh.vertex_mm.size());
  for (std::uint32_t i = 0; i < mesh.vertex_mm.size(); ++i) first[i] = places.first_at(mesh.vertex_mm, i);
  for (Face& face : mesh.face) {
    for (std::uint32_t& index : face) index = first[index];
  }
  return std::erase_if(mesh.face, [](const Face& f) { return f[0] == f[1] || f[1] == f[2] || f[0] == f[2]; });
}

Adjacency adjacency_of(const Mesh& mesh) {
  struct Side {
    std::uint32_t low, high;  // the edge's vertices
    std::uint32_t face, edge;
    bool operator<(const Side& other) const {
      return low != other.low ? low < other.low : high != other.high ? high < other.high : face < other.face;
    }
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.face.size());
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.face[f][k], mesh.face[f][(k + 1) % 3]);
      sides.push_back({low, high, f, k});
    }
  }
  std::sort(sides.begin(), sides.end());
  Adjacency adjacency;
  adjacency.beside.resize(mesh.face.size());
  for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
    for (next = i; next < sides.size() && sides[next].low == sides[i].low && sides[next].high == sides[i].high;) ++next;
    if (next - i > 2) ++adjacency.branching_edges;
    for (std::size_t at = i; at < next; ++at) {
      adjacency.beside[sides[at].face][sides[at].edge] = next - i == 1   ? Adjacency::kOpen
                                                         : next - i == 2 ? sides[2 * i + 1 - at].face
                                                                         : Adjacency::kBranching;
    }
  }
  return adjacency;
}

void take_out_specks(Mesh& mesh, MeshRepair& report) {
  Groups groups(mesh.vertex_mm.size());
  for (const Face& face : mesh.face) {
    groups.join(face[0], face[1]);
    groups.join(face[0], face[2]);
  }
  const std::map<std::uint32_t, Piece> pieces = pieces_of(mesh, groups);
  double whole_mm2 = 0.0;
  Piece main;
  for (const auto& [group, piece] : pieces) {
    whole_mm2 += piece.area_mm2;
    if (piece.area_mm2 > main.area_mm2) main = piece;
  }
  const auto speck = [&](const Piece& piece) {
    return piece.area_mm2 < kSpeckShare * whole_mm2 && !piece.box.intersects(main.box);
  };
  std::vector<Piece> bodies;
  double specks_mm2 = 0.0;
  for (const auto& [group, piece] : pieces) {
    if (piece.area_mm2 >= kSpeckShare * whole_mm2) bodies.push_back(piece);
    if (!speck(piece)) continue;
    specks_mm2 += piece.area_mm2;
    ++report.specks;
  }
  report.pieces = bodies_apart(bodies);
  if (specks_mm2 > kSpecksShare * whole_mm2) report.specks = 0;
  if (report.specks == 0) return;
  std::erase_if(mesh.face, [&](const Face& face) { return speck(pieces.at(groups.of(face[0]))); });
}

void measure_holes(const Mesh& mesh, const Adjacency& adjacency, MeshRepair& report) {
  const std::vector<std::array<std::uint32_t, 2>> open = open_edges(mesh, adjacency);
  report.open_edges = open.size();
  Groups groups(mesh.vertex_mm.size());
  for (const auto& [from, to] : open) groups.join(from, to);
  struct Loop {
    Vec3 sum_mm = Vec3::Zero();
    double count = 0.0;
    double area_mm2 = 0.0;
  };
  std::map<std::uint32_t, Loop> loops;
  for (const auto& [from, to] : open) {
    Loop& loop = loops[groups.of(from)];
    loop.sum_mm += (mesh.vertex_mm[from] + mesh.vertex_mm[to]).cast<double>();
    loop.count += 2.0;
  }
  for (const auto& [from, to] : open) {
    Loop& loop = loops[groups.of(from)];
    const Vec3 a = mesh.vertex_mm[from].cast<double>() - loop.sum_mm / loop.count;
    const Vec3 b = mesh.vertex_mm[to].cast<double>() - loop.sum_mm / loop.count;
    loop.area_mm2 += 0.5 * a.cross(b).norm();
  }
  double surface_mm2 = 0.0;
  for (const Face& face : mesh.face) surface_mm2 += area_mm2(mesh, face);
  double holes_mm2 = 0.0;
  for (const auto& [group, loop] : loops) {
    if (loop.area_mm2 < kHoleShare * surface_mm2) continue;
    ++report.holes;
    holes_mm2 += loop.area_mm2;
  }
  report.hole_share = surface_mm2 > 0.0 ? holes_mm2 / surface_mm2 : 0.0;
}

}  // namespace beltpick::teach
