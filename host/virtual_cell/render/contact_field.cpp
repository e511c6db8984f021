#include "virtual_cell/render/contact_field.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace beltpick::virtual_cell {
namespace {

constexpr double kCellsAcross = 140.0;

// Distance to a triangle, by the regions of its plane (Ericson, Real-Time Collision Detection, 5.1.5).
double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const auto segment = [&p](const Vec3& from, const Vec3& along) {
    const double t = std::clamp((p - from).dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
    return (p - from - t * along).norm();
  };
  const Vec3 normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  if (area2 > 1e-20) {
    const double v = normal.dot((p - a).cross(ac)) / area2;
    const double w = normal.dot(ab.cross(p - a)) / area2;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) return std::abs(normal.dot(p - a)) / std::sqrt(area2);
  }
  return std::min({segment(a, ab), segment(a, ac), segment(b, c - b)});
}

}  // namespace

ContactField::ContactField(const ScenePart& part) {
  Eigen::AlignedBox3d box;
  for (const Vec3f& v : part.mesh.vertex_mm) box.extend(v.cast<double>());
  cell_mm_ = box.diagonal().norm() / kCellsAcross;
  band_mm_ = 2.0 * cell_mm_;
  // The odd fraction keeps grid columns off the vertices of regular meshes, where a parity count is undecided.
  origin_mm_ = box.min() - Vec3::Constant(band_mm_ + cell_mm_) + cell_mm_ * Vec3(0.0091, 0.0181, 0.0062);
  for (int axis = 0; axis < 3; ++axis) {
    size_[axis] = static_cast<int>(std::ceil((box.sizes()[axis] + 2.0 * band_mm_) / cell_mm_)) + 3;
  }
  distance_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2], static_cast<float>(band_mm_));
  measure(part.mesh);
  sign(part.mesh);
}

// Unsigned distances within the band of every triangle.
void ContactField::measure(const Mesh& mesh) {
  for (const auto& face : mesh.face) {
    const Vec3 a = mesh.vertex_mm[face[0]].cast<double>();
    const Vec3 b = mesh.vertex_mm[face[1]].cast<double>();
    const Vec3 c = mesh.vertex_mm[face[2]].cast<double>();
    const Vec3 low = (a.cwiseMin(b).cwiseMin(c) - Vec3::Constant(band_mm_) - origin_mm_) / cell_mm_;
    const Vec3 high = (a.cwiseMax(b).cwiseMax(c) + Vec3::Constant(band_mm_) - origin_mm_) / cell_mm_;
    for (int k = static_cast<int>(std::ceil(low.z())); k <= high.z(); ++k) {
      for (int j = static_cast<int>(std::ceil(low.y())); j <= high.y(); ++j) {
        for (int i = static_cast<int>(std::ceil(low.x())); i <= high.x(); ++i) {
          float& nearest = distance_[at(i, j, k)];
          nearest = std::min(nearest, static_cast<float>(triangle_distance(corner(i, j, k), a, b, c)));
        }
      }
    }
  }
}

// Inside is where a vertical line has crossed the surface an odd number of times.
void ContactField::sign(const Mesh& mesh) {
  std::vector<std::vector<float>> crossings(static_cast<std::size_t>(size_[0]) * size_[1]);
  for (const auto& face : mesh.face) {
    const Vec3 a = mesh.vertex_mm[face[0]].cast<double>();
    const Vec3 ab = mesh.vertex_mm[face[1]].cast<double>() - a;
    const Vec3 ac = mesh.vertex_mm[face[2]].cast<double>() - a;
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    if (std::abs(area) < 1e-12) continue;
    const Vec3 low = (a + ab.cwiseMin(ac).cwiseMin(0.0) - origin_mm_) / cell_mm_;
    const Vec3 high = (a + ab.cwiseMax(ac).cwiseMax(0.0) - origin_mm_) / cell_mm_;
    for (int j = static_cast<int>(std::ceil(low.y())); j <= high.y(); ++j) {
      for (int i = static_cast<int>(std::ceil(low.x())); i <= high.x(); ++i) {
        const Vec3 p = corner(i, j, 0) - a;
        const double v = (p.x() * ac.y() - p.y() * ac.x()) / area;
        const double w = (ab.x() * p.y() - ab.y() * p.x()) / area;
        if (v < 0.0 || w < 0.0 || v + w > 1.0) continue;
        crossings[static_cast<std::size_t>(j) * size_[0] + i].push_back(
            static_cast<float>(a.z() + v * ab.z() + w * ac.z()));
      }
    }
  }
  for (int j = 0; j < size_[1]; ++j) {
    for (int i = 0; i < size_[0]; ++i) {
      auto& column = crossings[static_cast<std::size_t>(j) * size_[0] + i];
      std::sort(column.begin(), column.end());
      for (int k = 0; k < size_[2]; ++k) {
        const auto z = static_cast<float>(corner(i, j, k).z());
        const auto below = std::lower_bound(column.begin(), column.end(), z) - column.begin();
        if (below % 2 != 0) distance_[at(i, j, k)] = -distance_[at(i, j, k)];
      }
    }
  }
}

double ContactField::distance(const Vec3& point_part_mm) const {
  const Vec3 g = (point_part_mm - origin_mm_) / cell_mm_;
  if (!(g.minCoeff() >= 0.0) || g.x() >= size_[0] - 1 || g.y() >= size_[1] - 1 || g.z() >= size_[2] - 1)
    return band_mm_;
  const int i = static_cast<int>(g.x());
  const int j = static_cast<int>(g.y());
  const int k = static_cast<int>(g.z());
  const double u = g.x() - i;
  const double v = g.y() - j;
  const double w = g.z() - k;
  const auto along_x = [&](int dj, int dk) {
    const float* d = &distance_[at(i, j + dj, k + dk)];
    return d[0] + u * (static_cast<double>(d[1]) - d[0]);
  };
  const double near = along_x(0, 0) + v * (along_x(1, 0) - along_x(0, 0));
  const double far = along_x(0, 1) + v * (along_x(1, 1) - along_x(0, 1));
  return near + w * (far - near);
}

Vec3 ContactField::outward(const Vec3& p) const {
  constexpr double kStep = 0.4;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    g[axis] = distance(p + kStep * Vec3::Unit(axis)) - distance(p - kStep * Vec3::Unit(axis));
  }
  const double length = g.norm();
  return length > 1e-9 ? Vec3(g / length) : Vec3(Vec3::UnitZ());
}

}  // namespace beltpick::virtual_cell
