// Model: a candidate primitive, and which points belong to it.
#pragma once

#include "primitives/msac.hpp"

namespace beltpick::primitives {

// Relative to the cloud's origin. Plane: points q with direction . (q - point) = 0.
struct Model {
  PrimitiveKind kind = PrimitiveKind::kPlane;
  Vec3 point_mm = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();
  double radius_mm = 0.0;
  double side = 1.0;  // +1 boss: normals point away from the axis or centre; -1 bore
};

// A point against a model: its distance from the surface with sign, outwards of it (out of a bore's wall means towards
// the wall's material), and the surface's own normal there.
struct Residual {
  double distance_mm = 0.0;
  Vec3 outward = Vec3::UnitZ();
};
inline Residual residual(const Model& model, const Vec3& point_mm) {
  Vec3 offset_mm = point_mm - model.point_mm;
  if (model.kind == PrimitiveKind::kPlane) return {model.direction.dot(offset_mm), model.direction};
  if (model.kind == PrimitiveKind::kCylinder) offset_mm -= offset_mm.dot(model.direction) * model.direction;
  const double length_mm = offset_mm.norm();
  if (length_mm < 1e-9) return {-model.radius_mm, Vec3::Zero()};
  return {length_mm - model.radius_mm, offset_mm / length_mm};
}

// The constant T of equation (4) in mm^2: 99 % of the points of the surface lie closer (chi square, one freedom).
inline double threshold_mm2(const PrimitiveQuery& query) { return 6.635 * query.sigma_mm * query.sigma_mm; }

// Least agreement (cosine) between a point's normal and the surface's; below -1 where normals are not used.
double least_agreement(const PrimitiveQuery& query);

// The judgement of one point that cost() makes of all.
struct InlierRule {
  double threshold_mm2, least_agreement;

  explicit InlierRule(const PrimitiveQuery& query)
      : threshold_mm2(primitives::threshold_mm2(query)), least_agreement(primitives::least_agreement(query)) {}

  // `r`: the point's residual against the model.
  [[nodiscard]] bool holds(const Cloud& cloud, int i, const Model& model, const Residual& r) const {
    return r.distance_mm * r.distance_mm < threshold_mm2 &&
           model.side * r.outward.dot(cloud.normal(i)) >= least_agreement;
  }
};

struct Support {
  int inliers = 0;
  double rms_mm = 0.0;
  double extent_mm = 0.0;  // along the axis, without the outermost 1 % at both ends
  double middle_mm = 0.0;  // of that extent, along the direction from the model's point
  double arc_rad = 0.0;    // about the axis
  Vec3 centroid_mm = Vec3::Zero();
};
Support support_of(const Cloud& cloud, const Model& model, const PrimitiveQuery& query);

}  // namespace beltpick::primitives
