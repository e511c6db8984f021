#include "icp/normal_equations.hpp"

#include <algorithm>

namespace beltpick::icp {
namespace {

// Tukey's biweight: 1 at no distance, 0 from the radius on.
float tukey_weight(float distance2, float radius2) {
  const float rest = 1.0F - distance2 / radius2;
  return rest > 0.0F ? rest * rest : 0.0F;
}

void add_row(NormalEquations& system, const Vec3& arm, const Vec3& normal, double residual, double weight) {
  Vec6 row;
  row << arm.cross(normal), normal;
  const Vec6 weighted = weight * row;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) system.information(i, j) += weighted[i] * row[j];
  }
  system.gradient += weighted * residual;
}

// The transformation of measured points into the part frame, in single precision for speed.
struct IntoPart {
  Eigen::Matrix3f rotation;
  Vec3f translation;
  Vec3f centre;

  IntoPart(const PartModel& model, const PartPose& T_camera_part) {
    const auto T_part_camera = T_camera_part.inverse();
    rotation = T_part_camera.rotation.cast<float>();
    translation = T_part_camera.translation_mm.cast<float>();
    centre = model.centre_mm.cast<float>();
  }
  [[nodiscard]] Vec3f operator()(const Vec3f& point) const { return rotation * point + translation; }
};

void add_surface(NormalEquations& system, std::span<const OrientedPoint> sample, const PartModel& model,
                 const IntoPart& into_part, const Stage& stage) {
  const float radius2 = static_cast<float>(stage.radius_mm * stage.radius_mm);
  // The nearest of sampled points lies up to about this far aside of the foot on the surface.
  const float aside = 0.75F * model.spacing_mm;
  for (const OrientedPoint& measured : sample) {
    const Vec3f at = into_part(measured.point_mm);
    const OrientedPoint& nearest = model.nearest(at);
    if (nearest.normal.dot(into_part.rotation * measured.normal) < stage.facing) continue;
    const Vec3f apart = at - nearest.point_mm;
    const float residual = nearest.normal.dot(apart);
    const Vec3f sideways = apart - residual * nearest.normal;
    const float beyond = std::max(0.0F, sideways.norm() - aside);
    const float weight = tukey_weight(residual * residual + beyond * beyond, radius2);
    if (weight <= 0.0F) continue;
    const Vec3 arm = (at - into_part.centre).cast<double>();
    add_row(system, arm, nearest.normal.cast<double>(), residual, weight);
    system.weight += weight;
    system.weighted_square += weight * residual * residual;
    ++system.inliers;
    if (stage.beyond > 0.0F && beyond > 0.0F) {
      add_row(system, arm, sideways.normalized().cast<double>(), beyond, stage.beyond * weight);
    }
  }
}

void add_outline(NormalEquations& system, std::span<const OutlinePair> outline, const IntoPart& into_part,
                 const Stage& stage, double outline_weight) {
  // Outlines are found less exactly than surfaces.
  const float radius = 1.5F * static_cast<float>(stage.radius_mm);
  for (const OutlinePair& pair : outline) {
    const Vec3f at = into_part(pair.measured_mm);
    const float residual = pair.outward.dot(at - pair.on_part_mm);
    const double weight = outline_weight * tukey_weight(residual * residual, radius * radius);
    if (weight <= 0.0) continue;
    add_row(system, (at - into_part.centre).cast<double>(), pair.outward.cast<double>(), residual, weight);
  }
}

}  // namespace

NormalEquations linearise(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& T_camera_part,
                          const Stage& stage, std::span<const OutlinePair> outline, double outline_weight) {
  const IntoPart into_part(model, T_camera_part);
  NormalEquations system;
  add_surface(system, sample, model, into_part, stage);
  add_outline(system, outline, into_part, stage, outline_weight);
  system.information.triangularView<Eigen::StrictlyUpper>() = system.information.transpose();
  return system;
}

}  // namespace beltpick::icp
