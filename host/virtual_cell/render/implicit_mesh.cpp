#include "virtual_cell/render/implicit_mesh.hpp"

#include <array>
#include <cmath>

namespace beltpick::virtual_cell {
namespace {

constexpr std::uint32_t kNoVertex = 0xffffffffU;

// The distance function sampled at the corners of a grid of cubes.
struct SampledGrid {
  Vec3 origin_mm;
  double cell_mm = 1.0;
  std::array<int, 3> corners{};
  std::vector<float> distance;

  [[nodiscard]] std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * corners[1] + j) * corners[0] + i;
  }
  [[nodiscard]] Vec3 corner(int i, int j, int k) const { return origin_mm + cell_mm * Vec3(i, j, k); }
};

SampledGrid sample(const SignedDistance& solid, const Eigen::AlignedBox3d& box, double cell_mm) {
  SampledGrid grid;
  grid.cell_mm = cell_mm;
  grid.origin_mm = box.min() - Vec3::Constant(2.0 * cell_mm);
  for (int axis = 0; axis < 3; ++axis) {
    grid.corners[axis] = static_cast<int>(std::ceil(box.sizes()[axis] / cell_mm)) + 5;
  }
  grid.distance.resize(static_cast<std::size_t>(grid.corners[0]) * grid.corners[1] * grid.corners[2]);
  for (int k = 0; k < grid.corners[2]; ++k) {
    for (int j = 0; j < grid.corners[1]; ++j) {
      for (int i = 0; i < grid.corners[0]; ++i) {
        grid.distance[grid.at(i, j, k)] = static_cast<float>(solid(grid.corner(i, j, k)));
      }
    }
  }
  return grid;
}

Vec3 gradient(const SignedDistance& solid, const Vec3& p) {
  constexpr double kStep = 0.02;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = kStep * Vec3::Unit(axis);
    g[axis] = (solid(p + step) - solid(p - step)) / (2.0 * kStep);
  }
  return g;
}

// Moves a point onto the surface, but not out of the neighbourhood of its cell.
Vec3 onto_surface(const SignedDistance& solid, const Vec3& start, double reach_mm) {
  Vec3 p = start;
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Vec3 g = gradient(solid, p);
    if (g.squaredNorm() < 0.05) break;
    p -= solid(p) * g / g.squaredNorm();
  }
  return (p - start).norm() <= reach_mm ? p : start;
}

// Mean of the points where the surface crosses the cell's edges; false when it does not cross the cell.
bool crossing_centre(const SampledGrid& grid, int i, int j, int k, Vec3& centre) {
  Vec3 sum = Vec3::Zero();
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      std::array<int, 3> a{i, j, k};
      a[(axis + 1) % 3] += edge & 1;
      a[(axis + 2) % 3] += edge >> 1;
      std::array<int, 3> b = a;
      b[axis] += 1;
      const double da = grid.distance[grid.at(a[0], a[1], a[2])];
      const double db = grid.distance[grid.at(b[0], b[1], b[2])];
      if ((da < 0.0) == (db < 0.0)) continue;
      const Vec3 from = grid.corner(a[0], a[1], a[2]);
      sum += from + (da / (da - db)) * (grid.corner(b[0], b[1], b[2]) - from);
      ++crossings;
    }
  }
  if (crossings == 0) return false;
  centre = sum / crossings;
  return true;
}

// The two triangles across the grid edge from corner (i, j, k) along `axis`, when the surface crosses it.
void add_quadrilateral(const SampledGrid& grid, const std::vector<std::uint32_t>& vertex_of_cell,
                       const std::array<int, 3>& corner, int axis, Mesh& mesh) {
  std::array<int, 3> next = corner;
  next[axis] += 1;
  const bool inside = grid.distance[grid.at(corner[0], corner[1], corner[2])] < 0.0F;
  if (inside == (grid.distance[grid.at(next[0], next[1], next[2])] < 0.0F)) return;
  std::array<std::uint32_t, 4> quad{};
  constexpr std::array<std::array<int, 2>, 4> kAround{{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
  for (int n = 0; n < 4; ++n) {
    std::array<int, 3> cell = corner;
    cell[(axis + 1) % 3] += kAround[n][0];
    cell[(axis + 2) % 3] += kAround[n][1];
    quad[n] = vertex_of_cell[grid.at(cell[0], cell[1], cell[2])];
  }
  if (!inside) std::swap(quad[1], quad[3]);
  mesh.face.push_back({quad[0], quad[1], quad[2]});
  mesh.face.push_back({quad[0], quad[2], quad[3]});
}

}  // namespace

Mesh mesh_of_solid(const SignedDistance& solid, const Eigen::AlignedBox3d& box, double cell_mm) {
  const SampledGrid grid = sample(solid, box, cell_mm);
  std::vector<std::uint32_t> vertex_of_cell(grid.distance.size(), kNoVertex);
  Mesh mesh;
  for (int k = 0; k + 1 < grid.corners[2]; ++k) {
    for (int j = 0; j + 1 < grid.corners[1]; ++j) {
      for (int i = 0; i + 1 < grid.corners[0]; ++i) {
        Vec3 centre;
        if (!crossing_centre(grid, i, j, k, centre)) continue;
        vertex_of_cell[grid.at(i, j, k)] = static_cast<std::uint32_t>(mesh.vertex_mm.size());
        mesh.vertex_mm.push_back(onto_surface(solid, centre, cell_mm).cast<float>());
      }
    }
  }
  for (int k = 1; k + 1 < grid.corners[2]; ++k) {
    for (int j = 1; j + 1 < grid.corners[1]; ++j) {
      for (int i = 1; i + 1 < grid.corners[0]; ++i) {
        for (int axis = 0; axis < 3; ++axis) add_quadrilateral(grid, vertex_of_cell, {i, j, k}, axis, mesh);
      }
    }
  }
  return mesh;
}

}  // namespace beltpick::virtual_cell
