#include "teach/simulated_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "base/units.hpp"

namespace beltpick::teach {

namespace {

// The default rig: 1280 x 960 pixels on 400 x 300 mm from 700 mm away.
constexpr int kCols = 1280;
constexpr int kRows = 960;
constexpr double kDistance_mm = 700.0;
constexpr double kFocal_px = kCols * kDistance_mm / 400.0;
constexpr double kLargestPart_mm = 260.0;  // that this distance is good for
constexpr double kBetweenAxes_rad = rad_from_deg(30.0);
constexpr double kShadowBias_mm = 1.0;
constexpr double kGrazing = 0.17;  // cosine: what leans away farther is not measured

// Depths seen from an eye, and which triangle each pixel shows.
struct DepthBuffer {
  DepthBuffer(int rows_, int cols_)
      : rows(rows_),
        cols(cols_),
        depth(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_), std::numeric_limits<float>::max()),
        triangle(depth.size(), kNone) {}

  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  // Corners in the eye's frame: z is the depth.
  void draw(const Vec3f& a, const Vec3f& b, const Vec3f& c, std::uint32_t number, const Lens& lens) {
    if (std::min({a.z(), b.z(), c.z()}) <= 1.0F) return;
    const Eigen::Vector2f pa = pixel(a, lens), pb = pixel(b, lens), pc = pixel(c, lens);
    const float area = cross(pb - pa, pc - pa);
    if (area == 0.0F) return;
    const int left = std::max(0, static_cast<int>(std::ceil(std::min({pa.x(), pb.x(), pc.x()}))));
    const int right = std::min(cols - 1, static_cast<int>(std::floor(std::max({pa.x(), pb.x(), pc.x()}))));
    const int top = std::max(0, static_cast<int>(std::ceil(std::min({pa.y(), pb.y(), pc.y()}))));
    const int bottom = std::min(rows - 1, static_cast<int>(std::floor(std::max({pa.y(), pb.y(), pc.y()}))));
    for (int row = top; row <= bottom; ++row) {
      for (int col = left; col <= right; ++col) {
        const Eigen::Vector2f p(static_cast<float>(col), static_cast<float>(row));
        const float wa = cross(pb - p, pc - p) / area;
        const float wb = cross(pc - p, pa - p) / area;
        const float wc = 1.0F - wa - wb;
        if (wa < 0.0F || wb < 0.0F || wc < 0.0F) continue;
        const float z = 1.0F / (wa / a.z() + wb / b.z() + wc / c.z());
        const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
        if (z >= depth[at]) continue;
        depth[at] = z;
        triangle[at] = number;
      }
    }
  }

  // Whether something lies nearer to the eye than this point, clearly.
  [[nodiscard]] bool hides(const Vec3f& at, const Lens& lens) const {
    const Eigen::Vector2f p = pixel(at, lens);
    const auto col = static_cast<int>(std::lround(p.x()));
    const auto row = static_cast<int>(std::lround(p.y()));
    if (row < 0 || col < 0 || row >= rows || col >= cols) return false;
    const auto index = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
    return depth[index] < at.z() - static_cast<float>(kShadowBias_mm);
  }

  static float cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return a.x() * b.y() - a.y() * b.x(); }
  static Eigen::Vector2f pixel(const Vec3f& at, const Lens& lens) {
    return {static_cast<float>(lens.fx_px) * at.x() / at.z() + static_cast<float>(lens.cx_px),
            static_cast<float>(lens.fy_px) * at.y() / at.z() + static_cast<float>(lens.cy_px)};
  }

  int rows, cols;
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;
};

// The eye's own frame from the camera's.
struct Eye {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation_mm = Vec3::Zero();

  [[nodiscard]] std::vector<Vec3f> sees(const std::vector<Vec3f>& camera_mm) const {
    const Eigen::Matrix3f turn = rotation.cast<float>();
    const Vec3f shift = translation_mm.cast<float>();
    std::vector<Vec3f> seen;
    seen.reserve(camera_mm.size());
    for (const Vec3f& at : camera_mm) seen.emplace_back(turn * at + shift);
    return seen;
  }
};

DepthBuffer draw_all(const std::vector<Vec3f>& corners, const Lens& lens) {
  DepthBuffer buffer(lens.height, lens.width);
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    buffer.draw(corners[k], corners[k + 1], corners[k + 2], static_cast<std::uint32_t>(k / 3), lens);
  }
  return buffer;
}

// Rotation that takes `down` (part) to the camera's z (away from it, to the belt), turned about it.
Mat3 standing(const Placement& placement) {
  const Eigen::Quaterniond onto = Eigen::Quaterniond::FromTwoVectors(placement.down, Vec3::UnitZ());
  return (Eigen::AngleAxisd(placement.turn_rad, Vec3::UnitZ()) * onto).toRotationMatrix();
}

// Bell-shaped, variance 1: the sum of twelve evenly spread numbers.
double bell(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

}  // namespace

Triangles triangles_of(const Mesh& mesh, const Surface& surface) {
  Triangles triangles;
  for (const auto& face : mesh.face) {
    for (const std::uint32_t index : face) triangles.push_back(mesh.vertex_mm[index]);
  }
  if (!triangles.empty()) return triangles;
  const auto half = static_cast<float>(0.7 * surface.spacing_mm);
  for (std::size_t i = 0; i < surface.point_mm.size(); ++i) {
    const Vec3f u = half * surface.normal[i].unitOrthogonal();
    const Vec3f v = surface.normal[i].cross(u);
    const Vec3f& at = surface.point_mm[i];
    for (const Vec3f& corner : {Vec3f(at - u - v), Vec3f(at + u - v), Vec3f(at + u + v), Vec3f(at - u - v),
                                Vec3f(at + u + v), Vec3f(at - u + v)}) {
      triangles.push_back(corner);
    }
  }
  return triangles;
}

SimulatedView simulate_view(const Triangles& triangles, double size_mm, const Placement& placement, double noise_mm,
                            std::uint64_t seed) {
  SimulatedView view;
  view.rows = kRows;
  view.cols = kCols;
  view.lens = {kCols, kRows, kFocal_px, kFocal_px, 0.5 * (kCols - 1), 0.5 * (kRows - 1), {}};
  const double distance_mm = kDistance_mm * std::max(1.0, size_mm / kLargestPart_mm);
  const Mat3 rotation = standing(placement);
  Eigen::AlignedBox3d box;
  for (const Vec3f& corner : triangles) box.extend(rotation * corner.cast<double>());
  view.T_camera_part.rotation = rotation;
  view.T_camera_part.translation_mm = {placement.x_mm - box.center().x(), placement.y_mm - box.center().y(),
                                       distance_mm - box.max().z()};
  const std::vector<Vec3f> corners = Eye{rotation, view.T_camera_part.translation_mm}.sees(triangles);
  const DepthBuffer seen = draw_all(corners, view.lens);

  // The projector looks at the middle of the belt from the side.
  view.projector_mm = {-distance_mm * std::tan(kBetweenAxes_rad), 0.0, 0.0};
  Eye projector;
  projector.rotation = Eigen::AngleAxisd(-kBetweenAxes_rad, Vec3::UnitY()).toRotationMatrix();
  projector.translation_mm = -(projector.rotation * view.projector_mm);
  const DepthBuffer lit = draw_all(projector.sees(corners), view.lens);
  const Eigen::Matrix3f to_projector = projector.rotation.cast<float>();
  const Vec3f from_camera = projector.translation_mm.cast<float>();

  Random random(seed, 9);
  view.point_mm.assign(seen.depth.size(), Vec3f::Zero());
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const auto at = static_cast<std::size_t>(row) * kCols + static_cast<std::size_t>(col);
      const std::uint32_t triangle = seen.triangle[at];
      const bool part = triangle != DepthBuffer::kNone;
      const double depth_mm = part ? static_cast<double>(seen.depth[at]) : distance_mm;
      const Vec3 ray((col - view.lens.cx_px) / kFocal_px, (row - view.lens.cy_px) / kFocal_px, 1.0);
      const Vec3f point = ((depth_mm + noise_mm * bell(random)) * ray).cast<float>();
      if (lit.hides((to_projector * (depth_mm * ray).cast<float>()) + from_camera, view.lens)) continue;
      if (part) {
        const Vec3f& a = corners[3 * static_cast<std::size_t>(triangle)];
        Vec3f normal = (corners[3 * static_cast<std::size_t>(triangle) + 1] - a)
                           .cross(corners[3 * static_cast<std::size_t>(triangle) + 2] - a)
                           .normalized();
        const float facing = -normal.dot(point.normalized());
        const Vec3f to_light = (view.projector_mm.cast<float>() - point).normalized();
        if (std::abs(facing) < kGrazing || normal.dot(to_light) * facing < 0.0F) continue;
        if (facing < 0.0F) normal = -normal;
        view.of_part.push_back({point, normal});
      }
      view.point_mm[at] = point;
    }
  }
  return view;
}

}  // namespace beltpick::teach
