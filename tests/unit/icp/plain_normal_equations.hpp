// The normal equations point by point in double precision: what the kernel of icp/normal_equations.cpp must give.
#pragma once

#include <algorithm>

#include "icp/normal_equations.hpp"

namespace beltpick::test {

inline void add_plain_row(icp::NormalEquations& system, const Vec3& arm, const Vec3& normal, double residual,
                          double weight) {
  icp::Vec6 row;
  row << arm.cross(normal), normal;
  system.information += weight * row * row.transpose();
  system.gradient += weight * residual * row;
}

// Without outline pairs.
inline icp::NormalEquations plain_normal_equations(std::span<const OrientedPoint> sample, const PartModel& model,
                                                   const icp::PartPose& T_camera_part, const icp::Stage& stage) {
  const auto T_part_camera = T_camera_part.inverse();
  icp::NormalEquations system;
  for (const OrientedPoint& measured : sample) {
    const Vec3 at = T_part_camera * measured.point_mm.cast<double>();
    const OrientedPoint& nearest = model.nearest(at.cast<float>());
    const Vec3 normal = nearest.normal.cast<double>();
    if (normal.dot(T_part_camera.rotation * measured.normal.cast<double>()) < stage.facing) continue;
    const Vec3 apart = at - nearest.point_mm.cast<double>();
    const double residual = normal.dot(apart);
    const Vec3 sideways = apart - residual * normal;
    const double beyond = std::max(0.0, sideways.norm() - 0.75 * model.spacing_mm);
    const double rest = 1.0 - (residual * residual + beyond * beyond) / (stage.radius_mm * stage.radius_mm);
    if (rest <= 0.0) continue;
    const double weight = rest * rest;  // Tukey's biweight
    add_plain_row(system, at - model.centre_mm, normal, residual, weight);
    system.weight += weight;
    system.weighted_square += weight * residual * residual;
    ++system.inliers;
    if (stage.beyond > 0.0F && beyond > 0.0) {
      add_plain_row(system, at - model.centre_mm, sideways.normalized(), beyond, stage.beyond * weight);
    }
  }
  return system;
}

}  // namespace beltpick::test
