#include "calibrate/belt_frame.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "contract/result_codes.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kRounds = 8;
constexpr double kTukey = 4.685;          // for 95 % of the efficiency of least squares
constexpr double kLeastSpread_mm = 0.01;  // a belt without noise
constexpr double kNear_mm = 5.0;          // of the first plane: farther is no belt
constexpr double kLeastShare = 0.1;

// 1.4826 times the median of |heights|: a standard deviation that objects do not disturb.
double robust_spread_mm(const RangeImage& range, const Plane& plane) {
  std::vector<double> heights;
  for (std::size_t i = 0; i < range.point_mm.size(); ++i) {
    const Vec3f& point_mm = range.point_mm.data[i];
    if (point_mm.z() <= 0.0F) continue;
    const double height_mm = std::abs(plane.height_mm(point_mm.cast<double>()));
    if (height_mm < kNear_mm) heights.push_back(height_mm);
  }
  if (heights.empty()) return kLeastSpread_mm;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return std::max(kLeastSpread_mm, 1.4826 * *middle);
}

double tukey_weight(double residual, double spread) {
  const double share = residual / (kTukey * spread);
  if (std::abs(share) >= 1.0) return 0.0;
  const double rest = 1.0 - share * share;
  return rest * rest;
}

template <class Visitor>
void each_weighted(const RangeImage& range, const Plane& plane, double spread_mm, Visitor visit) {
  for (std::size_t i = 0; i < range.point_mm.size(); ++i) {
    if (range.point_mm.data[i].z() <= 0.0F) continue;
    const Vec3 point_mm = range.point_mm.data[i].cast<double>();
    const double height_mm = plane.height_mm(point_mm);
    const double weight = tukey_weight(height_mm, spread_mm);
    if (weight > 0.0) visit(point_mm, height_mm, weight);
  }
}

Plane weighted_plane(const RangeImage& range, const Plane& plane, double spread_mm) {
  const Vec3 about_mm = plane.offset_mm * plane.normal;
  Vec3 sum = Vec3::Zero();
  Mat3 square = Mat3::Zero();
  double total = 0.0;
  each_weighted(range, plane, spread_mm, [&](const Vec3& point_mm, double, double weight) {
    const Vec3 off_mm = point_mm - about_mm;
    sum += weight * off_mm;
    square += weight * off_mm * off_mm.transpose();
    total += weight;
  });
  if (!(total > 10.0)) return plane;
  const Vec3 mean = sum / total;
  const Mat3 spread = square / total - mean * mean.transpose();
  Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
  if (normal.dot(plane.normal) < 0.0) normal = -normal;
  return {normal, normal.dot(mean + about_mm)};
}

// From lowest to highest of a z = 1, u, v, u^2, u v, v^2 surface over what was measured of the belt.
double bow_mm(const RangeImage& range, const Plane& plane, double spread_mm) {
  using Terms = Eigen::Matrix<double, 6, 1>;
  const Vec3 u = plane.normal.unitOrthogonal();
  const Vec3 v = plane.normal.cross(u);
  const Vec3 about_mm = plane.offset_mm * plane.normal;
  constexpr double kScale_mm = 100.0;
  const auto terms_at = [&](const Vec3& point_mm) {
    const double x = u.dot(point_mm - about_mm) / kScale_mm, y = v.dot(point_mm - about_mm) / kScale_mm;
    Terms terms;
    terms << 1.0, x, y, x * x, x * y, y * y;
    return terms;
  };
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Terms right = Terms::Zero();
  each_weighted(range, plane, spread_mm, [&](const Vec3& point_mm, double height_mm, double weight) {
    const Terms terms = terms_at(point_mm);
    normal += weight * terms * terms.transpose();
    right += weight * height_mm * terms;
  });
  const Terms surface = normal.ldlt().solve(right);
  double low_mm = 0.0, high_mm = 0.0;
  each_weighted(range, plane, spread_mm, [&](const Vec3& point_mm, double, double) {
    const double height_mm = surface.dot(terms_at(point_mm));
    low_mm = std::min(low_mm, height_mm);
    high_mm = std::max(high_mm, height_mm);
  });
  return high_mm - low_mm;
}

int measured_points(const RangeImage& range) {
  return static_cast<int>(std::count_if(range.point_mm.data, range.point_mm.data + range.point_mm.size(),
                                        [](const Vec3f& point_mm) { return point_mm.z() > 0.0F; }));
}

}  // namespace

Result<BeltPlane> fit_belt_plane(const RangeImage& range, const Plane& start) {
  Plane plane = start;
  double spread_mm = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    spread_mm = robust_spread_mm(range, plane);
    plane = weighted_plane(range, plane, spread_mm);
  }
  if (plane.normal.z() > 0.0) plane = {-plane.normal, -plane.offset_mm};
  BeltPlane belt;
  belt.plane = plane;
  double sum = 0.0, total = 0.0;
  each_weighted(range, plane, spread_mm, [&](const Vec3&, double height_mm, double weight) {
    sum += weight * height_mm * height_mm;
    total += weight;
    ++belt.points;
  });
  const int measured = measured_points(range);
  belt.inlier_share = measured > 0 ? static_cast<double>(belt.points) / measured : 0.0;
  if (belt.inlier_share < kLeastShare) {
    return failure(
        ResultCode::kTooFewPoints,
        "only %.1f %% of the %d measured points lie on one plane, at least 10 %% are expected of a belt; capture "
        "the bare belt",
        100.0 * belt.inlier_share, measured);
  }
  belt.rms_mm = std::sqrt(sum / total);
  belt.bow_mm = bow_mm(range, plane, spread_mm);
  return belt;
}

BeltPose belt_frame_on(const Plane& plane, const std::optional<BeltPose>& earlier) {
  Vec3 origin_mm = Vec3::UnitZ() * (plane.offset_mm / plane.normal.z());
  Vec3 along = Vec3::UnitX();
  if (earlier) {
    const auto T_camera_belt = earlier->inverse();
    origin_mm = T_camera_belt.translation_mm - plane.height_mm(T_camera_belt.translation_mm) * plane.normal;
    along = T_camera_belt.rotation.col(0);
  }
  const Vec3 x = (along - along.dot(plane.normal) * plane.normal).normalized();
  Pose<frame::Camera, frame::Belt> T_camera_belt;
  T_camera_belt.rotation << x, plane.normal.cross(x), plane.normal;
  T_camera_belt.translation_mm = origin_mm;
  return T_camera_belt.inverse();
}

BeltPose belt_frame_from(const PlatePosition& T_camera_plate, double thickness_mm) {
  const Mat3& plate = T_camera_plate.rotation;
  Pose<frame::Camera, frame::Belt> T_camera_belt;
  T_camera_belt.rotation << plate.col(0), -plate.col(1), -plate.col(2);
  T_camera_belt.translation_mm = T_camera_plate * Vec3(0.0, 0.0, thickness_mm);
  return T_camera_belt.inverse();
}

Plane belt_plane_of(const BeltPose& T_belt_camera) {
  const auto T_camera_belt = T_belt_camera.inverse();
  const Vec3 normal = T_camera_belt.rotation.col(2);
  return {normal, normal.dot(T_camera_belt.translation_mm)};
}

}  // namespace beltpick::calibrate
