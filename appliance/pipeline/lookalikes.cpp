#include "pipeline/lookalikes.hpp"

#include <array>

#include "base/units.hpp"

namespace beltpick::pipeline {
namespace {

using Turn = Pose<frame::Part, frame::Part>;

// Turns by which bolt circles and square bodies repeat themselves, nearly.
constexpr std::array<double, 11> kTurns_deg{45, 60, 90, 120, 135, 180, 225, 240, 270, 300, 315};
// Before it is aligned anew a lookalike may fit worse by this share of the part's diagonal.
constexpr double kWorseShare = 0.015;

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
  const Vec3 centre_mm = T_camera_part * model.centre_mm;
  for (int x = 0; x < 3; ++x) {
    for (int step = 1; step <= 2; ++step) {
      for (int signs = 0; signs < 4; ++signs) {
        Mat3 turn;
        turn.row(0) = Vec3::Unit(x).transpose() * (signs % 2 == 0 ? 1.0 : -1.0);
        turn.row(1) = Vec3::Unit((x + step) % 3).transpose() * (signs / 2 == 0 ? 1.0 : -1.0);
        turn.row(2) = turn.row(0).cross(turn.row(1));
        const Mat3 rotation = T_camera_part.rotation * turn;
        offer(other, {rotation, centre_mm - rotation * other.centre_mm}, sample, worst, pool);
      }
    }
  }
}

}  // namespace beltpick::pipeline
