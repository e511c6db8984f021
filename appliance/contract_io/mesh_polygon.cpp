#include <algorithm>

#include "contract_io/mesh_parts.hpp"

namespace beltpick::contract_io {

namespace {

using Corners = std::vector<std::uint32_t>;

// Of a polygon that is cut up with care, which takes the square of their number; more is no modeller's face.
constexpr std::size_t kMostCorners = 2000;

// The polygon's area vector (Newell's method): along its normal, whether convex or not.
Vec3 area_vector(const Corners& corners, const Mesh& mesh) {
  const Vec3 origin = mesh.vertex_mm[corners[0]].cast<double>();
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vec3 a = mesh.vertex_mm[corners[k - 1]].cast<double>() - origin;
    const Vec3 b = mesh.vertex_mm[corners[k]].cast<double>() - origin;
    sum += a.cross(b);
  }
  return sum;
}

// Twice the area of a triangle, negative where it turns against `normal`.
double turning(const Mesh& mesh, const Vec3& normal, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Vec3 from = mesh.vertex_mm[a].cast<double>();
  return (mesh.vertex_mm[b].cast<double>() - from).cross(mesh.vertex_mm[c].cast<double>() - from).dot(normal);
}

// Whether the corner can be cut off: it turns the polygon's way and no other corner lies in its triangle.
bool is_ear(const Corners& corners, std::size_t at, const Mesh& mesh, const Vec3& normal) {
  const std::uint32_t a = corners[(at + corners.size() - 1) % corners.size()];
  const std::uint32_t b = corners[at];
  const std::uint32_t c = corners[(at + 1) % corners.size()];
  if (turning(mesh, normal, a, b, c) <= 0) return false;
  return std::none_of(corners.begin(), corners.end(), [&](std::uint32_t p) {
    return p != a && p != b && p != c && turning(mesh, normal, a, b, p) >= 0 && turning(mesh, normal, b, c, p) >= 0 &&
           turning(mesh, normal, c, a, p) >= 0;
  });
}

void cut_ear(Corners& corners, std::size_t at, Mesh& mesh) {
  const std::size_t count = corners.size();
  mesh.face.push_back({corners[(at + count - 1) % count], corners[at], corners[(at + 1) % count]});
  corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace

void add_polygon(const Corners& corners, Mesh& mesh) {
  if (corners.size() < 3) return;
  const bool known =
      std::all_of(corners.begin(), corners.end(), [&](std::uint32_t index) { return index < mesh.vertex_mm.size(); });
  Corners left = corners;
  if (known && corners.size() <= kMostCorners) {
    const Vec3 normal = area_vector(corners, mesh);
    while (left.size() > 3) {
      std::size_t ear = 0;
      while (ear < left.size() && !is_ear(left, ear, mesh, normal)) ++ear;
      if (ear == left.size()) break;  // crosses itself, or has no area left
      cut_ear(left, ear, mesh);
    }
  }
  for (std::size_t k = 2; k < left.size(); ++k) mesh.face.push_back({left[0], left[k - 1], left[k]});
}

}  // namespace beltpick::contract_io
