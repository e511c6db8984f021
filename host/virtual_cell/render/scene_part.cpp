// Mass properties by the divergence theorem, normals by crease angle.
#include "virtual_cell/render/scene_part.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kCreaseAngleDeg = 35.0;
constexpr double kSmallestMm = 5.0, kLargestMm = 2000.0;

// Sums over the tetrahedra from the origin to each face: volume, first and second moments.
void add_mass(ScenePart& part) {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& face : part.mesh.face) {
    const Vec3 a = part.mesh.vertex_mm[face[0]].cast<double>();
    const Vec3 b = part.mesh.vertex_mm[face[1]].cast<double>();
    const Vec3 c = part.mesh.vertex_mm[face[2]].cast<double>();
    const double six_volume = a.dot(b.cross(c));
    const Vec3 sum = a + b + c;
    volume += six_volume / 6.0;
    first += six_volume / 24.0 * sum;
    second += six_volume / 120.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  part.volume_mm3 = volume;
  part.centre_of_mass_mm = first / volume;
  const Mat3 central = second - volume * part.centre_of_mass_mm * part.centre_of_mass_mm.transpose();
  part.inertia_mm5 = central.trace() * Mat3::Identity() - central;
}

// Each corner takes the area-weighted mean of the faces round its vertex that turn by less than the crease angle.
void add_corner_normals(ScenePart& part) {
  const Mesh& mesh = part.mesh;
  std::vector<Vec3f> area_normal;
  std::vector<std::vector<std::uint32_t>> faces_of_vertex(mesh.vertex_mm.size());
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    const auto& face = mesh.face[f];
    const Vec3f origin = mesh.vertex_mm[face[0]];
    area_normal.push_back((mesh.vertex_mm[face[1]] - origin).cross(mesh.vertex_mm[face[2]] - origin));
    for (const std::uint32_t vertex : face) faces_of_vertex[vertex].push_back(f);
  }
  const auto crease = static_cast<float>(std::cos(rad_from_deg(kCreaseAngleDeg)));
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    const Vec3f own = area_normal[f].normalized();
    for (const std::uint32_t vertex : mesh.face[f]) {
      Vec3f sum = Vec3f::Zero();
      for (const std::uint32_t other : faces_of_vertex[vertex]) {
        if (own.dot(area_normal[other].normalized()) >= crease) sum += area_normal[other];
      }
      part.corner_normal.push_back(sum.squaredNorm() > 0.0F ? sum.normalized() : own);
    }
  }
}

}  // namespace

Result<ScenePart> make_part(std::string name, Mesh mesh) {
  if (mesh.face.empty())
    return failure(ResultCode::kMeshInvalid, "part %s: expected a mesh with faces, found none; export it as triangles",
                   name.c_str());
  Eigen::AlignedBox3f box;
  for (const Vec3f& vertex : mesh.vertex_mm) box.extend(vertex);
  if (!(box.diagonal().norm() >= kSmallestMm && box.diagonal().norm() <= kLargestMm))
    return failure(ResultCode::kMeshInvalid, "part %s: expected %g..%g mm across, found %.3g; check the mesh's unit",
                   name.c_str(), kSmallestMm, kLargestMm, static_cast<double>(box.diagonal().norm()));
  ScenePart part;
  part.name = std::move(name);
  part.mesh = std::move(mesh);
  add_mass(part);
  if (!(part.volume_mm3 > 1.0))
    return failure(ResultCode::kMeshInvalid, "part %s: expected a closed mesh wound outwards, found volume %.3g mm3",
                   part.name.c_str(), part.volume_mm3);
  add_corner_normals(part);
  return part;
}

}  // namespace beltpick::virtual_cell
