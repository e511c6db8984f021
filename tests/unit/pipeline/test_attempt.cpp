// When two poses are one.
#include "pipeline/attempt.hpp"

#include <catch2/catch.hpp>

using namespace beltpick;

namespace {

PartModel part() {
  PartModel model;
  model.centre_mm = {4.0, -3.0, 9.0};
  model.diagonal_mm = 100.0;
  return model;
}

pipeline::Candidate somewhere() {
  pipeline::Candidate candidate;
  const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  candidate.alignment.T_camera_part = {turned, {30.0, -20.0, 700.0}};
  return candidate;
}

// Turned about its centre and shifted.
pipeline::Candidate moved(const pipeline::Candidate& from, const Vec3& shift_mm, double turn_rad) {
  pipeline::Candidate to = from;
  auto& pose = to.alignment.T_camera_part;
  const Vec3 centre_mm = pose * part().centre_mm;
  pose.rotation = Eigen::AngleAxisd(turn_rad, Vec3::UnitY()).toRotationMatrix() * pose.rotation;
  pose.translation_mm += centre_mm + shift_mm - pose * part().centre_mm;
  return to;
}

}  // namespace

TEST_CASE("two poses are one while they differ by less than half of what is promised", "[attempt]") {
  const pipeline::Candidate one = somewhere();
  const double most_rad = pipeline::kSamePose_rad, most_mm = pipeline::kSamePose_mm;
  CHECK(pipeline::same_pose(one, one, part()));
  CHECK(pipeline::same_pose(one, moved(one, {0.99 * most_mm, 0.0, 0.0}, 0.99 * most_rad), part()));
  CHECK_FALSE(pipeline::same_pose(one, moved(one, {0.0, 0.0, 1.01 * most_mm}, 0.0), part()));
  CHECK_FALSE(pipeline::same_pose(one, moved(one, Vec3::Zero(), 1.01 * most_rad), part()));
  // They may still have found the same place: within 1.2 mm, this part's diagonal.
  CHECK(pipeline::same_place(one, moved(one, {0.0, 0.0, 1.1}, 2.0 * most_rad), part()));
  CHECK_FALSE(pipeline::same_place(one, moved(one, {0.0, 0.0, 1.3}, 0.0), part()));
  pipeline::Candidate other_part = one;
  other_part.model_index = 1;
  CHECK_FALSE(pipeline::same_pose(one, other_part, part()));
}

TEST_CASE("a part and its mirror image in one place are not one pose", "[attempt]") {
  const pipeline::Candidate one = somewhere();
  for (int axis = 0; axis < 3; ++axis) {
    pipeline::Candidate other = one;
    auto& pose = other.alignment.T_camera_part;
    pose.rotation.col(axis) *= -1.0;
    pose.translation_mm += one.alignment.T_camera_part * part().centre_mm - pose * part().centre_mm;
    CHECK_FALSE(pipeline::same_pose(one, other, part()));
    CHECK_FALSE(pipeline::same_place(one, other, part()));
  }
}
