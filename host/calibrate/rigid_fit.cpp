#include "calibrate/rigid_fit.hpp"

#include <Eigen/SVD>

namespace beltpick::calibrate {
namespace {

Vec3 mean_of(std::span<const Vec3> points_mm) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& point_mm : points_mm) sum += point_mm;
  return sum / static_cast<double>(points_mm.size());
}

}  // namespace

RigidFit fit_rigid(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm) {
  const Vec3 from_mean_mm = mean_of(from_mm);
  const Vec3 to_mean_mm = mean_of(to_mm);
  Mat3 correlation = Mat3::Zero();
  double from_square = 0.0;
  for (std::size_t i = 0; i < from_mm.size(); ++i) {
    correlation += (to_mm[i] - to_mean_mm) * (from_mm[i] - from_mean_mm).transpose();
    from_square += (from_mm[i] - from_mean_mm).squaredNorm();
  }
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 sign = Vec3::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) sign.z() = -1.0;  // a mirror is no motion
  RigidFit fit;
  fit.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  fit.translation_mm = to_mean_mm - fit.rotation * from_mean_mm;
  fit.scale = svd.singularValues().dot(sign) / from_square;
  return fit;
}

}  // namespace beltpick::calibrate
