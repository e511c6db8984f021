#include "icp/normal_equations.hpp"

namespace beltpick::icp {
namespace {

// Tukey's biweight: 1 at no distance, 0 from the radius on.
float tukey_weight(float distance2, float radius2) {
  const float rest = 1.0F - distance2 / radius2;
  return rest > 0.0F ? rest * rest : 0.0F;
}

void add(NormalEquations& system, const Vec3& arm, const Vec3& normal, double residual, double weight) {
  Vec6 row;
  row << arm.cross(normal), normal;
  const Vec6 weighted = weight * row;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) system.information(i, j) += weighted[i] * row[j];
  }
  system.gradient += weighted * residual;
  system.weight += weight;
  system.weighted_square += weight * residual * residual;
  ++system.inliers;
}

}  // namespace

NormalEquations linearise(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& T_camera_part,
                          const Stage& stage) {
  const auto T_part_camera = T_camera_part.inverse();
  const Eigen::Matrix3f rotation = T_part_camera.rotation.cast<float>();
  const Vec3f translation = T_part_camera.translation_mm.cast<float>();
  const Vec3f centre = model.centre_mm.cast<float>();
  const float radius2 = static_cast<float>(stage.radius_mm * stage.radius_mm);
  // The nearest of sampled points lies up to about half the spacing aside of the foot on the surface.
  const float aside2 = 0.5F * model.spacing_mm * model.spacing_mm;
  NormalEquations system;
  for (const OrientedPoint& measured : sample) {
    const Vec3f at = rotation * measured.point_mm + translation;
    const OrientedPoint& nearest = model.nearest(at);
    if (nearest.normal.dot(rotation * measured.normal) < stage.facing) continue;
    const Vec3f apart = at - nearest.point_mm;
    const float residual = nearest.normal.dot(apart);
    const float sideways2 = apart.squaredNorm() - residual * residual;
    const float beyond2 = sideways2 > aside2 ? sideways2 - aside2 : 0.0F;
    const float weight = tukey_weight(residual * residual + beyond2, radius2);
    if (weight <= 0.0F) continue;
    add(system, (at - centre).cast<double>(), nearest.normal.cast<double>(), residual, weight);
  }
  system.information.triangularView<Eigen::StrictlyUpper>() = system.information.transpose();
  return system;
}

}  // namespace beltpick::icp
