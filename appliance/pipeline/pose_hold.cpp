#include "pipeline/pose_hold.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "base/units.hpp"
#include "contract/freedoms.hpp"

namespace beltpick::pipeline {
namespace {

// The covariance counts random errors alone. What errs the same way at many points (the template's spacing, the bias of
// an outline) was seen to be some ten times as much; with that, a pose must be good enough to grip.
constexpr double kSystematic = 10.0;
constexpr double kAllowed_mm = 1.0;
constexpr double kAllowed_rad = rad_from_deg(1.0);

// A freedom held less firmly than this, by random errors, on the part's rim, is loose.
constexpr double kFirm_mm = 0.015;
// And one held less than this slides so easily that the outline alone decides where the part is.
constexpr double kSlack_mm = 0.03;

// The freedoms that the outline is asked about, and how: rounds of reweighting, the scatter of an end, and so many ends
// that would have the pose stay.
constexpr int kAsked = 3;
constexpr int kRounds = 15;
constexpr double kEndSigma_mm = 0.3;
constexpr double kPriorEnds = 3.0;

using Mat6 = Eigen::Matrix<double, 6, 6>;

// Takes turns about the axis of a body of revolution out: they do not change it.
Mat6 counted(const Alignment& alignment, const PartModel& model) {
  Mat6 across = Mat6::Identity();
  if (model.sphere) across.topLeftCorner<3, 3>().setZero();
  if (model.revolution) {
    const Vec3 axis = alignment.T_camera_part.rotation * model.axis_direction;
    across.topLeftCorner<3, 3>() -= axis * axis.transpose();
  }
  return across * alignment.covariance * across;
}

// Motions that shift the part's rim by 1 mm, independent of each other, the one held least first.
struct Freedoms {
  Motion sigma_mm;
  Mat6 motion;

  [[nodiscard]] int loose() const { return static_cast<int>((sigma_mm.array() > kFirm_mm).count()); }
};

Freedoms freedoms_at_rim(const Alignment& alignment, const PartModel& model) {
  Motion scale = Motion::Ones();
  scale.head<3>().setConstant(2.0 / model.diagonal_mm);
  const Mat6 on_rim_mm2 =
      scale.cwiseInverse().asDiagonal() * counted(alignment, model) * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Mat6> solved(on_rim_mm2);
  return {solved.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt(),
          scale.asDiagonal() * solved.eigenvectors().rowwise().reverse()};
}

}  // namespace

bool determined(const Alignment& alignment, const PartModel& model) {
  if (model.sphere) return true;
  const Mat6 covariance = counted(alignment, model);
  Eigen::SelfAdjointEigenSolver<Mat3> slide, turn;
  slide.computeDirect(Mat3(covariance.bottomRightCorner<3, 3>()), Eigen::EigenvaluesOnly);
  turn.computeDirect(Mat3(covariance.topLeftCorner<3, 3>()), Eigen::EigenvaluesOnly);
  return kSystematic * std::sqrt(slide.eigenvalues().maxCoeff()) < kAllowed_mm &&
         kSystematic * std::sqrt(turn.eigenvalues().maxCoeff()) < kAllowed_rad;
}

std::optional<Motion> loosest_freedom(const Alignment& alignment, const PartModel& model) {
  const Freedoms freedoms = freedoms_at_rim(alignment, model);
  if (freedoms.loose() == 0) return std::nullopt;
  return freedoms.motion.col(0);
}

bool held_by_outline(const Alignment& alignment, const PartModel& model) {
  const Freedoms freedoms = freedoms_at_rim(alignment, model);
  return freedoms.loose() >= 2 && freedoms.sigma_mm[0] >= kSlack_mm;
}

double asked_shift_mm(const Alignment& alignment, const PartModel& model, std::span<const icp::OutlinePair> ends) {
  if (!held_by_outline(alignment, model)) return 0.0;
  const Freedoms freedoms = freedoms_at_rim(alignment, model);
  const Eigen::Matrix<double, 6, kAsked> along = freedoms.motion.leftCols<kAsked>();
  const Vec3 centre_mm = alignment.T_camera_part * model.centre_mm;
  Vec3 asked_mm = Vec3::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Mat3 normal = Mat3::Identity() * kPriorEnds / kEndSigma_mm;
    Vec3 right = Vec3::Zero();
    for (const icp::OutlinePair& end : ends) {
      const Vec3 on_part_mm = alignment.T_camera_part * end.on_part_mm.cast<double>();
      const Vec3 outward = alignment.T_camera_part.rotation * end.outward.cast<double>();
      Motion gradient;
      gradient << (on_part_mm - centre_mm).cross(outward), outward;
      const Vec3 moves = along.transpose() * gradient;
      const double beyond_mm = outward.dot(end.measured_mm.cast<double>() - on_part_mm);
      // Least sum of distances: some ends are those of other things.
      const double weight = 1.0 / std::max(kEndSigma_mm, std::abs(beyond_mm - moves.dot(asked_mm)));
      normal += weight * moves * moves.transpose();
      right += weight * beyond_mm * moves;
    }
    asked_mm = normal.ldlt().solve(right);
  }
  // What is held firmly has not slid: there the ends tell how far outlines err.
  return asked_mm.head(std::min(kAsked, freedoms.loose())).norm();
}

Mat6 covariance_of_equivalent(const result::PartPose& other, const result::PartPose& pose, const PartModel& model,
                              const Mat6& covariance) {
  const Vec3 arm = other * model.centre_mm - pose * model.centre_mm;
  Mat6 about_other = Mat6::Identity();
  about_other.bottomLeftCorner<3, 3>() << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  return about_other * covariance * about_other.transpose();
}

void spread_free_turns(Mat6& covariance, const result::PartPose& T_camera_part, const PartModel& model) {
  const Vec3 through_mm = T_camera_part * model.axis_point_mm, centre_mm = T_camera_part * model.centre_mm;
  if (model.sphere) {
    for (int axis = 0; axis < 3; ++axis) add_free_turn(covariance, through_mm, Vec3::Unit(axis), centre_mm);
  } else if (model.revolution) {
    add_free_turn(covariance, through_mm, T_camera_part.rotation * model.axis_direction, centre_mm);
  }
}

result::PartPose moved(const result::PartPose& T_camera_part, const Motion& motion, const PartModel& model) {
  const Vec3 turn = motion.head<3>();
  const double angle = turn.norm();
  const Mat3 rotation =
      angle < 1e-12 ? Mat3(Mat3::Identity()) : Mat3(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix());
  const Vec3 centre_mm = T_camera_part * model.centre_mm;
  const Mat3 turned = rotation * T_camera_part.rotation;
  return {turned, centre_mm + motion.tail<3>() - turned * model.centre_mm};
}

}  // namespace beltpick::pipeline
