#include "scan_maker.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"

namespace beltpick::test {
namespace {

constexpr int kRows = 240, kCols = 320;
constexpr double kBelt_mm = 500.0;
constexpr double kFocal_px = 1000.0;

// Where a ray from the origin meets the triangle, as a multiple of it; 0: nowhere (Moeller and Trumbore).
double meet(const Vec3& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 one = b - a;
  const Vec3 two = c - a;
  const Vec3 across = ray.cross(two);
  const double volume = one.dot(across);
  if (std::abs(volume) < 1e-12) return 0.0;
  const double u = -a.dot(across) / volume;
  const Vec3 up = (-a).cross(one);
  const double v = ray.dot(up) / volume;
  return u < 0.0 || v < 0.0 || u + v > 1.0 ? 0.0 : two.dot(up) / volume;
}

Vec3 ray_of(int row, int col) { return {(col - 0.5 * kCols) / kFocal_px, (row - 0.5 * kRows) / kFocal_px, 1.0}; }

}  // namespace

scans::ScanSource SmallScan::source(const std::string& name) {
  return {name,
          {{point_mm.data(), kRows, kCols}, {}, {}},
          lens,
          {label.data(), kRows, kCols},
          Plane{-Vec3::UnitZ(), -kBelt_mm}};
}

scans::CutOut SmallScan::part() const {
  scans::CutOut cut{.labels = {1}, .row_min = 0, .row_max = kRows - 1, .col_min = 0, .col_max = kCols - 1};
  cut.pixels = static_cast<int>(std::count(label.begin(), label.end(), 1));
  return cut;
}

SmallScan take_scan(const Mesh& mesh, const Mat3& rotation, double noise_mm, std::uint64_t seed,
                    Pose<frame::Camera, frame::Part>& T_camera_part) {
  Vec3 low = Vec3::Constant(1e9);
  Vec3 high = -low;
  for (const Vec3f& v : mesh.vertex_mm) {
    low = low.cwiseMin(rotation * v.cast<double>());
    high = high.cwiseMax(rotation * v.cast<double>());
  }
  T_camera_part = {rotation, Vec3(-0.5 * (low + high).x(), -0.5 * (low + high).y(), kBelt_mm - high.z())};
  SmallScan scan;
  scan.lens = {kCols, kRows, kFocal_px, kFocal_px, 0.5 * kCols, 0.5 * kRows};
  scan.point_mm.resize(static_cast<std::size_t>(kRows) * kCols);
  scan.label.assign(scan.point_mm.size(), 0);
  std::vector<double> depth(scan.point_mm.size(), kBelt_mm);
  for (const auto& face : mesh.face) {
    std::array<Vec3, 3> corner;
    double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = T_camera_part * mesh.vertex_mm[face[k]].cast<double>();
      const double col = kFocal_px * corner[k].x() / corner[k].z() + 0.5 * kCols;
      const double row = kFocal_px * corner[k].y() / corner[k].z() + 0.5 * kRows;
      left = std::min(left, col), right = std::max(right, col), top = std::min(top, row),
      bottom = std::max(bottom, row);
    }
    for (int row = std::max(0, static_cast<int>(top)); row <= std::min<double>(kRows - 1, bottom + 1); ++row) {
      for (int col = std::max(0, static_cast<int>(left)); col <= std::min<double>(kCols - 1, right + 1); ++col) {
        const auto at = static_cast<std::size_t>(row) * kCols + static_cast<std::size_t>(col);
        const double hit = meet(ray_of(row, col), corner[0], corner[1], corner[2]);
        if (hit > 0.0 && hit < depth[at]) depth[at] = hit, scan.label[at] = 1;
      }
    }
  }
  Random random(seed);
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const auto at = static_cast<std::size_t>(row) * kCols + static_cast<std::size_t>(col);
      double noise = -6.0;
      for (int i = 0; i < 12; ++i) noise += random.uniform();
      scan.point_mm[at] = (ray_of(row, col) * (depth[at] + noise_mm * noise)).cast<float>();
    }
  }
  return scan;
}

}  // namespace beltpick::test
