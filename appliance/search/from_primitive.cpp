#include "search/from_primitive.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "search/views.hpp"

namespace beltpick::search {
namespace {

constexpr double kFaceReachShare = 0.12;  // of the part's diagonal: so far off is the middle of what is seen of a face

// The pose that turns the part by `rotation` and brings its point `of_part` to `to_camera`.
PartPose placed(const Mat3& rotation, const Vec3& of_part, const Vec3& to_camera) {
  return {rotation, to_camera - rotation * of_part};
}

int search_cylinder(const SearchInput& input, const Primitive& taught, const Primitive& found, HypothesisPool& pool) {
  Trials trials(input, pool);
  const double step = input.model.shift_step_mm;
  const int turns = turn_count(input.model);
  // What is seen lies on the taught length, give or take a quarter of both for ends measured badly.
  const double reach = 0.5 * std::abs(taught.extent_mm - found.extent_mm) + 0.25 * (taught.extent_mm + found.extent_mm);
  const int shifts = std::max(1, static_cast<int>(std::ceil(reach / step)));
  for (const double flip : {1.0, -1.0}) {
    for (int turn = 0; turn < turns; ++turn) {
      const Mat3 rotation = rotation_onto(flip * taught.direction, found.direction, 2.0 * kPi * turn / turns);
      for (int shift = -shifts; shift <= shifts; ++shift) {
        trials.add(placed(rotation, taught.point_mm, found.point_mm + shift * step * found.direction));
      }
    }
  }
  return 2 * turns * (2 * shifts + 1);
}

int search_plane(const SearchInput& input, const Primitive& taught, const Primitive& found, HypothesisPool& pool) {
  Trials trials(input, pool);
  const double step = input.model.face_step_mm;
  const int shifts = static_cast<int>(std::ceil(kFaceReachShare * input.model.diagonal_mm / step - 1e-6));
  const int turns = turn_count(input.model);
  const Vec3 u = found.direction.unitOrthogonal();
  const Vec3 v = found.direction.cross(u);
  for (int turn = 0; turn < turns; ++turn) {
    const Mat3 rotation = rotation_onto(taught.direction, found.direction, 2.0 * kPi * turn / turns);
    for (int i = -shifts; i <= shifts; ++i) {
      for (int j = -shifts; j <= shifts; ++j) {
        trials.add(placed(rotation, taught.point_mm, found.point_mm + step * (i * u + j * v)));
      }
    }
  }
  return turns * (2 * shifts + 1) * (2 * shifts + 1);
}

int search_sphere(const SearchInput& input, const Primitive& taught, const Primitive& found, HypothesisPool& pool) {
  Trials trials(input, pool);
  const int turns = turn_count(input.model);
  for (const Vec3& direction : view_directions()) {
    for (int turn = 0; turn < turns; ++turn) {
      const Mat3 rotation = rotation_onto(direction, Vec3::UnitZ(), 2.0 * kPi * turn / turns);
      trials.add(placed(rotation, taught.point_mm, found.point_mm));
    }
  }
  return PartModel::kViews * turns;
}

}  // namespace

Mat3 rotation_onto(const Vec3& from, const Vec3& to, double turn_rad) {
  const Eigen::Quaterniond onto = Eigen::Quaterniond::FromTwoVectors(from, to);
  return (Eigen::AngleAxisd(turn_rad, to) * onto).toRotationMatrix();
}

int turn_count(const PartModel& model) { return static_cast<int>(std::ceil(2.0 * kPi / model.turn_step_rad - 1e-6)); }

bool may_match(const Primitive& taught, const Primitive& found) {
  if (taught.kind != found.kind) return false;
  if (taught.kind == PrimitiveKind::kPlane) return true;
  const double tolerance_mm = 0.5 + 0.05 * taught.radius_mm;
  return taught.concave == found.concave && std::abs(taught.radius_mm - found.radius_mm) < tolerance_mm;
}

int search_from_primitive(const SearchInput& input, const Primitive& taught, const Primitive& found,
                          HypothesisPool& pool) {
  if (!may_match(taught, found)) return 0;
  switch (taught.kind) {
    case PrimitiveKind::kCylinder:
      return search_cylinder(input, taught, found, pool);
    case PrimitiveKind::kPlane:
      return search_plane(input, taught, found, pool);
    case PrimitiveKind::kSphere:
      return search_sphere(input, taught, found, pool);
  }
  return 0;
}

}  // namespace beltpick::search
