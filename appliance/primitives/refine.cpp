#include "primitives/refine.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace beltpick::primitives {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// Freedoms: shifts along x, y, z; turns of the direction towards two sides; radius. Those a kind does not have are kept
// still by leaving out their columns.
struct Frame {
  Vec3 side, third;
};

Vec6 jacobian(const Model& model, const Frame& frame, const Vec3& point_mm, const Vec3& outward) {
  const Vec3 offset_mm = point_mm - model.point_mm;
  Vec6 j = Vec6::Zero();
  j.head<3>() = -outward;
  if (model.kind == PrimitiveKind::kPlane) {
    j.head<3>() = -model.direction;
    j[3] = offset_mm.dot(frame.side), j[4] = offset_mm.dot(frame.third);
  } else if (model.kind == PrimitiveKind::kCylinder) {
    const double along_mm = offset_mm.dot(model.direction);
    j[3] = -along_mm * outward.dot(frame.side), j[4] = -along_mm * outward.dot(frame.third);
  }
  j[5] = -1.0;
  return j;
}

void apply(const Vec6& step, const Frame& frame, Model& model) {
  model.point_mm += step.head<3>();
  model.direction = (model.direction + step[3] * frame.side + step[4] * frame.third).normalized();
  model.radius_mm += step[5];
}

// Whether a freedom of the general six exists in this kind.
bool free_to_move(const Model& model, const PrimitiveQuery& query, int freedom) {
  if (freedom == 5) return model.kind != PrimitiveKind::kPlane && !query.radius_mm;
  if (freedom >= 3) return model.kind != PrimitiveKind::kSphere;
  return true;
}

struct Normals {
  Mat6 matrix = Mat6::Zero();
  Vec6 vector = Vec6::Zero();
  int inliers = 0;
};

Normals normal_equations(const Cloud& cloud, const PrimitiveQuery& query, const Model& model, const Frame& frame) {
  Normals sum;
  const InlierRule rule(query);
  for (int i = 0; i < cloud.count; ++i) {
    const Vec3 point_mm = cloud.point(i);
    const Residual r = residual(model, point_mm);
    if (!rule.holds(cloud, i, model, r)) continue;
    const double tukey = 1.0 - r.distance_mm * r.distance_mm / rule.threshold_mm2;
    const Vec6 j = jacobian(model, frame, point_mm, r.outward);
    sum.matrix += tukey * tukey * j * j.transpose();
    sum.vector -= tukey * tukey * r.distance_mm * j;
    ++sum.inliers;
  }
  return sum;
}

bool step_once(const Cloud& cloud, const PrimitiveQuery& query, Model& model) {
  const Vec3 side = model.direction.unitOrthogonal();
  const Frame frame{side, model.direction.cross(side)};
  Normals sum = normal_equations(cloud, query, model, frame);
  if (sum.inliers < 6) return false;
  // A little damping keeps still what the shape does not determine (shifts in the plane or along the axis).
  const double damping = 1e-9 * sum.matrix.trace() + 1e-12;
  for (int i = 0; i < 6; ++i) {
    if (!free_to_move(model, query, i)) {
      sum.matrix.row(i).setZero(), sum.matrix.col(i).setZero();
      sum.vector[i] = 0.0;
    }
    sum.matrix(i, i) += damping;
  }
  const Vec6 step = sum.matrix.ldlt().solve(sum.vector);
  if (!step.allFinite()) return false;
  apply(step, frame, model);
  return model.kind == PrimitiveKind::kPlane || model.radius_mm > 0;
}

}  // namespace

bool refine(const Cloud& cloud, const PrimitiveQuery& query, int rounds, double widening, Model& model) {
  PrimitiveQuery wide = query;
  wide.sigma_mm *= widening;
  Model refined = model;
  for (int round = 0; round < rounds; ++round) {
    if (!step_once(cloud, wide, refined)) return false;
  }
  if (model.kind != PrimitiveKind::kPlane && !query.radius_mm &&
      (refined.radius_mm < query.radius_min_mm || refined.radius_mm > query.radius_max_mm)) {
    return false;
  }
  model = refined;
  return true;
}

}  // namespace beltpick::primitives
