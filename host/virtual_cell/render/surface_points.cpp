#include "virtual_cell/render/surface_points.hpp"

#include <array>
#include <cmath>
#include <map>

namespace beltpick::virtual_cell {

std::vector<Vec3> surface_points(const ScenePart& part, double spacing_mm) {
  std::map<std::array<int, 3>, Vec3> farthest;
  const auto offer = [&](const Vec3& p) {
    const Vec3 cell = (p / spacing_mm).array().floor();
    auto [at, fresh] =
        farthest.try_emplace({static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}, p);
    const Vec3& centre = part.centre_of_mass_mm;
    if (!fresh && (p - centre).squaredNorm() > (at->second - centre).squaredNorm()) at->second = p;
  };
  for (const auto& face : part.mesh.face) {
    const Vec3 a = part.mesh.vertex_mm[face[0]].cast<double>();
    const Vec3 b = part.mesh.vertex_mm[face[1]].cast<double>();
    const Vec3 c = part.mesh.vertex_mm[face[2]].cast<double>();
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int steps = std::max(1, static_cast<int>(std::ceil(longest / (0.7 * spacing_mm))));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) offer(a + (b - a) * i / steps + (c - a) * j / steps);
    }
  }
  std::vector<Vec3> points;
  for (const auto& [cell, point] : farthest) points.push_back(point);
  return points;
}

}  // namespace beltpick::virtual_cell
