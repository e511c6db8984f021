#include "segment/support_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/units.hpp"

namespace beltpick::segment {

namespace {

constexpr std::size_t kPoints = 4096;
constexpr int kTrials = 400;
constexpr double kLeastShare = 0.10;
// A parallel plane farther away is the support if it has at least this share of the other's points.
constexpr double kLowerShare = 0.3;
constexpr double kParallel_rad = rad_from_deg(10.0);

double tolerance_mm(const Scale& scale, double z_mm) { return 3.0 * scale.sigma_mm(z_mm) + scale.pitch_mm(z_mm); }

std::optional<Plane> plane_through(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  if (normal.norm() < 1e-6) return {};
  Plane plane{normal.normalized(), 0.0};
  if (plane.normal.dot(a) > 0.0) plane.normal = -plane.normal;  // to the camera, whatever the view
  plane.offset_mm = plane.normal.dot(a);
  return plane;
}

}  // namespace

SupportPlaneFinder::SupportPlaneFinder(Arena& arena)
    : points_(arena.take<Vec3f>("segment: support plane", kPoints)),
      residuals_(arena.take<float>("segment: support plane", kPoints)) {}

void SupportPlaneFinder::sample(const RangeImage& range) {
  count_ = 0;
  const double share = static_cast<double>(range.point_mm.size()) / static_cast<double>(kPoints);
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(share))));
  for (int row = stride / 2; row < range.point_mm.rows; row += stride) {
    for (int col = stride / 2; col < range.point_mm.cols && count_ < kPoints; col += stride) {
      if (range.valid(row, col)) points_[count_++] = range.point_mm(row, col);
    }
  }
}

int SupportPlaneFinder::inliers(const Plane& plane, const Scale& scale) const {
  int count = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Vec3 point = points_[i].cast<double>();
    if (std::abs(plane.height_mm(point)) < tolerance_mm(scale, point.z())) ++count;
  }
  return count;
}

// Points that were seen farther away than the plane: nothing is seen through a belt.
int SupportPlaneFinder::behind(const Plane& plane, const Scale& scale) const {
  int count = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Vec3 point = points_[i].cast<double>();
    if (plane.height_mm(point) < -3.0 * tolerance_mm(scale, point.z())) ++count;
  }
  return count;
}

std::optional<Plane> SupportPlaneFinder::best_plane(const Scale& scale, const Plane* above) {
  Random random(1, count_);
  std::optional<Plane> best;
  double least_cost = static_cast<double>(count_);
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto draw = [&] { return Vec3(points_[random.below(static_cast<std::uint32_t>(count_))].cast<double>()); };
    const Vec3 a = draw();
    const Vec3 b = draw();
    const Vec3 c = draw();
    const auto plane = plane_through(a, b, c);
    if (!plane) continue;
    if (above != nullptr) {
      if (plane->normal.dot(above->normal) < std::cos(kParallel_rad)) continue;
      if (above->height_mm(a) > -3.0 * tolerance_mm(scale, a.z())) continue;
    }
    double cost = 0.0;
    for (std::size_t i = 0; i < count_ && cost < least_cost; ++i) {
      const Vec3 point = points_[i].cast<double>();
      const double share = plane->height_mm(point) / tolerance_mm(scale, point.z());
      cost += std::min(1.0, share * share);
    }
    if (cost < least_cost) {
      least_cost = cost;
      best = plane;
    }
  }
  return best;
}

Plane SupportPlaneFinder::refined(Plane plane, const Scale& scale) const {
  for (int round = 0; round < 5; ++round) {
    Vec3 sum = Vec3::Zero();
    Mat3 square = Mat3::Zero();
    int used = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3 point = points_[i].cast<double>();
      if (std::abs(plane.height_mm(point)) > tolerance_mm(scale, point.z())) continue;
      sum += point;
      square += point * point.transpose();
      ++used;
    }
    if (used < 10) return plane;
    const Vec3 mean = sum / used;
    const Mat3 spread = square / used - mean * mean.transpose();
    const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
    plane.normal = normal.dot(mean) > 0.0 ? Vec3(-normal) : normal;
    plane.offset_mm = plane.normal.dot(mean);
  }
  return plane;
}

double SupportPlaneFinder::spread_mm(const Plane& plane, const Scale& scale) {
  // A bent or textured belt leaves the tolerance of the noise: look twice as far as before, until it no longer grows.
  double band = 2.0;
  double spread = 0.0;
  for (int round = 0; round < 4; ++round) {
    std::size_t used = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3 point = points_[i].cast<double>();
      const double height_mm = std::abs(plane.height_mm(point));
      if (height_mm < band * tolerance_mm(scale, point.z())) residuals_[used++] = static_cast<float>(height_mm);
    }
    if (used == 0) return spread;
    const auto middle = residuals_.begin() + static_cast<std::ptrdiff_t>(used / 2);
    std::nth_element(residuals_.begin(), middle, residuals_.begin() + static_cast<std::ptrdiff_t>(used));
    const double now = 1.4826 * static_cast<double>(*middle);
    if (round > 0 && now < 1.1 * spread) break;
    spread = now;
    band *= 1.5;
  }
  return spread;
}

std::optional<SupportPlane> SupportPlaneFinder::find(const RangeImage& range, const Scale& scale) {
  sample(range);
  if (count_ < 50) return {};
  auto best = best_plane(scale, nullptr);
  if (!best) return {};
  best = refined(*best, scale);
  const int held = inliers(*best, scale);
  if (held < kLeastShare * static_cast<double>(count_)) return {};
  if (const auto lower = best_plane(scale, &*best)) {
    const Plane plane = refined(*lower, scale);
    if (inliers(plane, scale) > kLowerShare * held) best = plane;
  }
  if (behind(*best, scale) > inliers(*best, scale)) return {};
  return SupportPlane{*best, spread_mm(*best, scale)};
}

SupportPlane SupportPlaneFinder::measure(const RangeImage& range, const Scale& scale, const Plane& plane) {
  sample(range);
  return {plane, spread_mm(plane, scale)};
}

}  // namespace beltpick::segment
