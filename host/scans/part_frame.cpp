#include "scans/part_frame.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

namespace beltpick::scans {
namespace {

// The horizontal direction in which the surface extends farthest, to the right in the image.
Vec3 longest_across(const Mesh& surface, const Vec3& up) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3f& p : surface.vertex_mm) mean += p.cast<double>();
  mean /= static_cast<double>(surface.vertex_mm.size());
  const Vec3 right = (Vec3::UnitX() - up * up.x()).normalized();
  const Vec3 ahead = up.cross(right);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vec3f& p : surface.vertex_mm) {
    const Vec3 arm = p.cast<double>() - mean;
    const Eigen::Vector2d at(right.dot(arm), ahead.dot(arm));
    spread += at * at.transpose();
  }
  const Eigen::Vector2d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
  return (right * axis.x() + ahead * axis.y()) * (axis.x() < 0.0 ? -1.0 : 1.0);
}

}  // namespace

Pose<frame::Part, frame::Part> part_frame(const Mesh& surface, const ScanView& first) {
  const Vec3 up = first.belt ? Vec3(first.belt->normal.normalized()) : Vec3(-Vec3::UnitZ());
  const Vec3 x = longest_across(surface, up);
  Mat3 rotation;
  rotation << x.transpose(), up.cross(x).transpose(), up.transpose();
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max());
  Vec3 high = -low;
  for (const Vec3f& p : surface.vertex_mm) {
    const Vec3 at = rotation * p.cast<double>();
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  Vec3 origin = 0.5 * (low + high);
  if (first.belt) origin.z() = first.belt->offset_mm / first.belt->normal.norm();
  return {rotation, -origin};
}

}  // namespace beltpick::scans
