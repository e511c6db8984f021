#include "contract_io/template_judge.hpp"

#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"
#include "contract_io/grasps_io.hpp"

namespace beltpick::contract_io {
namespace {

constexpr double kLargest_mm = 10'000;       // of any coordinate of a part
constexpr double kRotationTolerance = 1e-3;  // of a matrix that was written with few digits
constexpr float kNormalTolerance = 0.05F;    // of a unit vector
constexpr double kOutsideBox = 0.01;         // of the diagonal, by which points may leave the box
constexpr double kFinest = 1e-6;             // of the diagonal, from point to point

bool sane(const Vec3& v_mm) { return v_mm.allFinite() && v_mm.cwiseAbs().maxCoeff() <= kLargest_mm; }

bool unit(const Vec3& direction) {
  return direction.allFinite() && std::abs(direction.norm() - 1.0) <= static_cast<double>(kNormalTolerance);
}

template <class Pose>
bool rigid(const Pose& pose) {
  const Mat3& r = pose.rotation;
  return r.allFinite() && sane(pose.translation_mm) &&
         (r * r.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < kRotationTolerance && r.determinant() > 0.0;
}

bool good(const Primitive& primitive) {
  const bool directed = primitive.kind == PrimitiveKind::kSphere || unit(primitive.direction);
  return sane(primitive.point_mm) && primitive.direction.allFinite() && directed &&
         std::isfinite(primitive.radius_mm) && primitive.radius_mm >= 0.0 && primitive.radius_mm <= kLargest_mm &&
         std::isfinite(primitive.extent_mm) && std::isfinite(primitive.inlier_share) && std::isfinite(primitive.rms_mm);
}

bool good(const Grasp& grasp) {
  return rigid(grasp.T_part_gripper) && std::isfinite(grasp.opening_mm) && grasp.opening_mm >= 0.0 &&
         grasp.opening_mm <= kLargest_mm;
}

bool share(double value) { return value >= 0.0 && value <= 1.0 + 1e-6; }

bool good(const TaughtCone& cone) {
  return sane(1e-3 * cone.apex_mm) && unit(cone.direction) && cone.half_angle_rad > 0.0 && cone.half_angle_rad < 1.58 &&
         std::isfinite(cone.from_mm) && std::isfinite(cone.to_mm) && share(cone.surface_share);
}

bool good(const RestingPosition& resting) {
  return unit(resting.down) && std::abs(resting.height_mm) <= kLargest_mm && share(resting.likelihood);
}

bool good(const RecognitionRoute& route, std::size_t primitives) {
  return route.primitive >= -1 && route.primitive < static_cast<int>(primitives) && share(route.visible) &&
         route.poses >= 0;
}

bool good(const SearchSteps& steps) {
  return steps.turn_rad >= 0.0 && steps.turn_rad <= 6.3 && steps.shift_mm >= 0.0 && steps.shift_mm <= kLargest_mm;
}

bool good(const Requirements& required) {
  return std::all_of(kRequirementMembers.begin(), kRequirementMembers.end(),
                     [&](const RequirementMember& member) { return share(required.*member.value); });
}

// What is wrong with the surface; null where nothing is.
const char* surface_fault(const PartTemplate& part) {
  if (!sane(part.box_min_mm) || !sane(part.box_max_mm)) return "box_min_mm, box_max_mm: expected a box of millimetres";
  const Vec3 size_mm = part.box_max_mm - part.box_min_mm;
  const double diagonal_mm = size_mm.norm();
  if (size_mm.minCoeff() < 0.0 || diagonal_mm < 1e-3) return "box_max_mm: expected greater than box_min_mm";
  if (!std::isfinite(part.spacing_mm) || part.spacing_mm <= kFinest * diagonal_mm || part.spacing_mm > diagonal_mm) {
    return "spacing_mm: expected a distance between neighbouring points";
  }
  const Vec3 slack_mm = Vec3::Constant(kOutsideBox * diagonal_mm);
  const Vec3f low = (part.box_min_mm - slack_mm).cast<float>();
  const Vec3f high = (part.box_max_mm + slack_mm).cast<float>();
  const auto outside = [&](const Vec3f& at) {
    return (at.array() < low.array()).any() || (at.array() > high.array()).any();
  };
  if (std::any_of(part.point_mm.begin(), part.point_mm.end(), outside)) return "points: expected within the box";
  const auto askew = [](const Vec3f& normal) { return std::abs(normal.norm() - 1.0F) > kNormalTolerance; };
  if (std::any_of(part.normal.begin(), part.normal.end(), askew)) return "normals: expected unit vectors";
  return nullptr;
}

const char* fault_of(const PartTemplate& part) {
  if (const char* fault = surface_fault(part)) return fault;
  const auto each = [](const auto& list) {
    return std::all_of(list.begin(), list.end(), [](const auto& item) { return good(item); });
  };
  if (!each(part.primitives)) return "primitives: expected finite places, unit directions, radii of 0 or more";
  if (!each(part.grasps)) return "grasps: expected rigid poses in mm and openings of 0 or more";
  if (part.gripper && gripper_fault(*part.gripper) != nullptr) return "gripper: expected sizes of jaws and palm in mm";
  if (!each(part.cones)) return "cones: expected finite places, unit directions, angles below a right one";
  if (!each(part.resting)) return "resting_positions: expected unit directions and likelihoods of 0 to 1";
  const auto planned = [&](const RecognitionRoute& route) { return good(route, part.primitives.size()); };
  if (!std::all_of(part.routes.begin(), part.routes.end(), planned)) {
    return "routes: expected numbers of primitives, likelihoods of 0 to 1";
  }
  if (!good(part.steps)) return "search_steps: expected an angle and a length";
  if (part.requirements && !good(*part.requirements)) return "requirements: expected shares of 0 to 1";
  const Symmetry& symmetry = part.symmetry;
  const bool turns = std::all_of(symmetry.elements.begin(), symmetry.elements.end(),
                                 [](const auto& element) { return rigid(element); });
  if (!turns || !sane(symmetry.axis_point_mm) || !unit(symmetry.axis_direction)) {
    return "symmetry: expected rigid poses in mm and a unit axis";
  }
  return nullptr;
}

}  // namespace

Result<void> judge_template(const PartTemplate& part, const std::string& source) {
  const char* fault = fault_of(part);
  if (fault == nullptr) return {};
  return failure(ResultCode::kValueOutOfRange, "%s: %s, found another; teach the part again", source.c_str(), fault);
}

}  // namespace beltpick::contract_io
