// The rigid motion, and the change of scale, that bring one set of points onto another best.
#pragma once

#include <span>

#include "base/pose.hpp"

namespace beltpick::calibrate {

struct RigidFit {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation_mm = Vec3::Zero();
  double scale = 1.0;  // by which the moved points would have to grow beside it; not part of the motion

  [[nodiscard]] Vec3 operator*(const Vec3& point_from_mm) const { return rotation * point_from_mm + translation_mm; }
};

// Least squares over pairs `from[i]` -> `to[i]` (Kabsch, Umeyama); at least three that are not on one line. `scale` is
// the best similarity's; the motion is the best without one.
RigidFit fit_rigid(std::span<const Vec3> from_mm, std::span<const Vec3> to_mm);

}  // namespace beltpick::calibrate
