// The poses that a part's symmetry makes the same as a given one.
#pragma once

#include <array>

#include "base/units.hpp"
#include "contract/part_model.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

// Of the turns of a body of revolution so many are tried, evenly spread.
inline constexpr int kEquivalentTurns = 12;

// Calls `accept(pose)` with the pose itself, then with those that look the same, until one is accepted; returns whether
// one was. A sphere is turned to six sides.
template <class Accept>
bool any_equivalent(const PartModel& model, const PartPose& T_camera_part, const Accept& accept) {
  using Turn = Pose<frame::Part, frame::Part>;
  const auto about = [&](const Vec3& axis, double angle_rad) {
    const Mat3 rotation = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
    return Turn{rotation, model.axis_point_mm - rotation * model.axis_point_mm};
  };
  const auto spun = [&](const PartPose& pose) {
    for (int k = 1; model.revolution && k < kEquivalentTurns; ++k) {
      if (accept(pose * about(model.axis_direction, 2.0 * kPi * k / kEquivalentTurns))) return true;
    }
    return false;
  };
  if (accept(T_camera_part) || spun(T_camera_part)) return true;
  for (int i = 0; i < model.symmetry_count; ++i) {
    const PartPose turned = T_camera_part * model.symmetries[static_cast<std::size_t>(i)];
    if (accept(turned) || spun(turned)) return true;
  }
  if (!model.sphere) return false;
  for (const Turn& side :
       std::array{about(Vec3::UnitX(), kPi / 2), about(Vec3::UnitX(), kPi), about(Vec3::UnitX(), -kPi / 2),
                  about(Vec3::UnitY(), kPi / 2), about(Vec3::UnitY(), -kPi / 2)}) {
    if (accept(T_camera_part * side)) return true;
  }
  return false;
}

}  // namespace beltpick::result
