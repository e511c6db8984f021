#include "scans/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace beltpick::scans {
namespace {

constexpr double kCellSpacings = 2.5;  // so wide that the far side does not show through
constexpr int kMostCells = 400;
// A surface seen at a slant beyond this says nothing about which side of it is seen.
constexpr float kFacing = 0.15F;

// The surface drawn along one direction, nearest point first.
double missing_from(const Mesh& surface, const Vec3& towards, double cell_mm) {
  const Vec3f sight = towards.cast<float>();
  const Vec3f u = sight.unitOrthogonal();
  const Vec3f v = sight.cross(u);
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max());
  Vec3f high = -low;
  for (const Vec3f& p : surface.vertex_mm) {
    const Vec3f at(u.dot(p), v.dot(p), sight.dot(p));
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  const float cell =
      std::max(static_cast<float>(cell_mm), std::max(high.x() - low.x(), high.y() - low.y()) / kMostCells);
  const int cols = static_cast<int>((high.x() - low.x()) / cell) + 1;
  const int rows = static_cast<int>((high.y() - low.y()) / cell) + 1;
  std::vector<float> depth(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), low.z() - 1.0F);
  std::vector<float> facing(depth.size(), 0.0F);
  for (std::size_t i = 0; i < surface.vertex_mm.size(); ++i) {
    const Vec3f& p = surface.vertex_mm[i];
    const auto at = static_cast<std::size_t>((v.dot(p) - low.y()) / cell) * static_cast<std::size_t>(cols) +
                    static_cast<std::size_t>((u.dot(p) - low.x()) / cell);
    if (sight.dot(p) <= depth[at]) continue;
    depth[at] = sight.dot(p);
    facing[at] = sight.dot(surface.vertex_normal[i]);
  }
  const auto seen = std::count_if(facing.begin(), facing.end(), [](float f) { return f > kFacing; });
  const auto inside = std::count_if(facing.begin(), facing.end(), [](float f) { return f < -kFacing; });
  return seen + inside == 0 ? 0.0 : static_cast<double>(inside) / static_cast<double>(seen + inside);
}

std::string name_of(int x, int y, int z) {
  if (x == 0 && y == 0) return z > 0 ? "top (+z)" : "underside (-z)";
  std::string name;
  const auto add = [&](int sign, char axis) {
    if (sign == 0) return;
    if (!name.empty()) name += ' ';
    name += sign > 0 ? '+' : '-';
    name += axis;
  };
  add(x, 'x');
  add(y, 'y');
  add(z, 'z');
  return name;
}

}  // namespace

std::vector<Side> find_missing(const Mesh& surface, double spacing_mm) {
  std::vector<Side> sides;
  for (int i = 0; i < 27; ++i) {
    const int x = i % 3 - 1;
    const int y = i / 3 % 3 - 1;
    const int z = i / 9 - 1;
    if (x == 0 && y == 0 && z == 0) continue;
    const Vec3 towards = Vec3(x, y, z).normalized();
    sides.push_back({name_of(x, y, z), towards, missing_from(surface, towards, kCellSpacings * spacing_mm)});
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.missing_share > b.missing_share; });
  return sides;
}

}  // namespace beltpick::scans
