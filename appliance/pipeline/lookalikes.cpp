#include "pipeline/lookalikes.hpp"

#include <array>
#include <cmath>

#include "base/units.hpp"

namespace beltpick::pipeline {
namespace {

using Turn = Pose<frame::Part, frame::Part>;

// Turns by which bolt circles and square bodies repeat themselves, nearly.
constexpr std::array<double, 11> kTurns_deg{45, 60, 90, 120, 135, 180, 225, 240, 270, 300, 315};
// Before it is aligned anew a lookalike may fit worse by this share of the part's diagonal.
constexpr double kWorseShare = 0.015;

constexpr double kLeastBend = 0.5;      // least difference between the directions of two faces that change places
constexpr double kClearlyAcross = 0.5;  // least part of a box's axis that lies across a bore's

// What a point off the part counts, as in the search.
constexpr double kCapShare = 0.08;

float mean_mm(const PartModel& model, const result::PartPose& pose, const search::SearchSample& sample,
              float give_up_mm) {
  return search::mean_distance_mm(sample, model, pose, static_cast<float>(kCapShare * model.diagonal_mm), give_up_mm);
}

float worst_mm(const PartModel& model, const result::PartPose& T_camera_part, const search::SearchSample& sample) {
  const auto diagonal_mm = static_cast<float>(model.diagonal_mm);
  return mean_mm(model, T_camera_part, sample, diagonal_mm) + static_cast<float>(kWorseShare) * diagonal_mm;
}

void offer(const PartModel& model, const result::PartPose& pose, const search::SearchSample& sample, float worst_mm,
           search::HypothesisPool& pool) {
  const float mean = mean_mm(model, pose, sample, worst_mm);
  if (mean < worst_mm) pool.offer({pose, mean});
}

// Calls `lay` with each of the 24 turns that take a box's axes to its axes, or, for handed -1, with their mirror
// images.
template <class Lay>
void for_ways_to_lie(double handed, const Lay& lay) {
  for (int x = 0; x < 3; ++x) {
    for (int step = 1; step <= 2; ++step) {
      for (int signs = 0; signs < 4; ++signs) {
        Mat3 way;
        way.row(0) = Vec3::Unit(x).transpose() * (signs % 2 == 0 ? 1.0 : -1.0);
        way.row(1) = Vec3::Unit((x + step) % 3).transpose() * (signs / 2 == 0 ? 1.0 : -1.0);
        way.row(2) = handed * way.row(0).cross(way.row(1));
        lay(way);
      }
    }
  }
}

}  // namespace

void offer_turns(const PartModel& model, const result::PartPose& T_camera_part, const search::SearchSample& sample,
                 search::HypothesisPool& pool) {
  const float worst = worst_mm(model, T_camera_part, sample);
  const auto turn_about = [&](const Vec3& point_mm, const Vec3& axis) {
    for (const double turn_deg : kTurns_deg) {
      const Mat3 turn = Eigen::AngleAxisd(rad_from_deg(turn_deg), axis).toRotationMatrix();
      offer(model, T_camera_part * Turn{turn, point_mm - turn * point_mm}, sample, worst, pool);
    }
  };
  for (int axis = 0; axis < 3; ++axis) turn_about(model.centre_mm, Vec3::Unit(axis));
  for (const Primitive& primitive : model.taught()) {
    if (primitive.kind == PrimitiveKind::kSphere) continue;
    const bool cylinder = primitive.kind == PrimitiveKind::kCylinder;
    turn_about(cylinder ? primitive.point_mm : model.centre_mm, primitive.direction.normalized());
  }
}

void offer_other(const PartModel& model, const result::PartPose& T_camera_part, const PartModel& other,
                 const search::SearchSample& sample, search::HypothesisPool& pool) {
  const float worst = worst_mm(model, T_camera_part, sample);
  for_ways_to_lie(1.0, [&](const Mat3& way) {
    const Mat3 rotation = T_camera_part.rotation * way;
    offer(other, {rotation, T_camera_part * model.centre_mm - rotation * other.centre_mm}, sample, worst, pool);
  });
}

void offer_mirrored(const PartModel& model, const result::PartPose& T_camera_part, const search::SearchSample& sample,
                    search::HypothesisPool& pool) {
  const float worst = worst_mm(model, T_camera_part, sample);
  const auto reflect = [&](const Mat3& reflection, const Vec3& about_mm) {
    offer(model, T_camera_part * Turn{reflection, about_mm - reflection * about_mm}, sample, worst, pool);
  };
  for_ways_to_lie(-1.0, [&](const Mat3& way) { reflect(way, model.centre_mm); });
  const auto reflect_across = [&](const Vec3& normal, const Vec3& about_mm) {
    reflect(Mat3::Identity() - 2.0 * normal * normal.transpose(), about_mm);
  };
  for (const Primitive& first : model.taught()) {
    const Vec3 direction = first.direction.normalized();
    for (int axis = 0; first.kind == PrimitiveKind::kCylinder && axis < 3; ++axis) {
      const Vec3 across = Vec3::Unit(axis) - direction * direction.dot(Vec3::Unit(axis));
      if (across.norm() > kClearlyAcross) reflect_across(across.normalized(), first.point_mm);
    }
    // Two faces change places: those of a wall, so that what stood before it stands behind it, or those of an edge, so
    // that of an angle with one leg longer than the other each leg is taken for the other one.
    for (const Primitive& second : model.taught()) {
      if (&second <= &first || first.kind != PrimitiveKind::kPlane || second.kind != PrimitiveKind::kPlane) continue;
      const Vec3 other = second.direction.normalized();
      const Vec3 across = direction - other;
      if (across.norm() < kLeastBend) continue;
      const double middle_mm = (direction.dot(first.point_mm) - other.dot(second.point_mm)) / across.norm();
      reflect_across(across.normalized(), middle_mm * across.normalized());
    }
  }
}

}  // namespace beltpick::pipeline
