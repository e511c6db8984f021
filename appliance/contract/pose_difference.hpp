// How far two poses of a part are apart, where turns that leave its surface unchanged do not count.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "contract/part_model.hpp"

namespace beltpick {

struct PoseDifference {
  double translation_mm = 0.0;  // of the centre of the part's box
  double rotation_rad = 0.0;
};

namespace detail {

// One that counts rotation at the part's rim, so that the symmetry element that fits best can be chosen.
inline double magnitude_mm(const PoseDifference& d, double radius_mm) {
  return d.translation_mm + d.rotation_rad * radius_mm;
}

inline PoseDifference plain_difference(const Pose<frame::Camera, frame::Part>& a,
                                       const Pose<frame::Camera, frame::Part>& b, const PartModel& model) {
  if (model.sphere) return {(a * model.axis_point_mm - b * model.axis_point_mm).norm(), 0.0};
  if (model.revolution) {
    const Vec3 axis_a = a.rotation * model.axis_direction;
    const Vec3 axis_b = b.rotation * model.axis_direction;
    const double angle = std::atan2(axis_a.cross(axis_b).norm(), axis_a.dot(axis_b));
    const Vec3 on_axis =
        model.axis_point_mm + model.axis_direction * model.axis_direction.dot(model.centre_mm - model.axis_point_mm);
    return {(a * on_axis - b * on_axis).norm(), angle};
  }
  return {(a * model.centre_mm - b * model.centre_mm).norm(), rotation_between_rad(a.rotation, b.rotation)};
}

}  // namespace detail

// The smallest difference between `a` and any pose that cannot be told from `b`.
inline PoseDifference difference_modulo_symmetry(const Pose<frame::Camera, frame::Part>& a,
                                                 const Pose<frame::Camera, frame::Part>& b, const PartModel& model) {
  const double radius_mm = 0.5 * model.diagonal_mm;
  PoseDifference best = detail::plain_difference(a, b, model);
  for (int i = 0; i < model.symmetry_count; ++i) {
    const PoseDifference other = detail::plain_difference(a, b * model.symmetries[static_cast<std::size_t>(i)], model);
    if (detail::magnitude_mm(other, radius_mm) < detail::magnitude_mm(best, radius_mm)) best = other;
  }
  return best;
}

}  // namespace beltpick
