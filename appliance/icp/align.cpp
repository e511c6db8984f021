#include "icp/align.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "icp/normal_equations.hpp"

namespace beltpick::icp {
namespace {

constexpr int kLeastInliers = 12;
// Freedoms that the sample determines less than this (against the best determined one) are left alone.
constexpr double kLeastInformation = 1e-5;

// Divides rotations by the part's radius so that all six unknowns are lengths and can be compared.
Vec6 length_scale(const PartModel& model) {
  Vec6 scale = Vec6::Ones();
  scale.head<3>().setConstant(2.0 / model.diagonal_mm);
  return scale;
}

// The step that minimises the linearised residuals, with nothing along freedoms that are not determined.
Vec6 solve(const NormalEquations& system, const Vec6& scale) {
  const Mat6 scaled = scale.asDiagonal() * system.information * scale.asDiagonal();
  const double damping = kLeastInformation * scaled.diagonal().maxCoeff();
  const Mat6 damped = scaled + damping * Mat6::Identity();
  return scale.cwiseProduct(damped.ldlt().solve(-scale.cwiseProduct(system.gradient)));
}

// The pose after the measured points have moved by `step` in the part frame.
PartPose moved(const PartPose& T_camera_part, const Vec6& step, const Vec3& centre) {
  const Vec3 turn = step.head<3>();
  const double angle = turn.norm();
  const Mat3 rotation =
      angle < 1e-15 ? Mat3(Mat3::Identity()) : Mat3(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix());
  const Vec3 shift = step.tail<3>();
  const Pose<frame::Part, frame::Part> motion{rotation, centre + shift - rotation * centre};
  PartPose next = T_camera_part * motion.inverse();
  // Products of many rotations drift from being one. A mirror image stays one.
  const double handed = next.rotation.determinant() < 0.0 ? -1.0 : 1.0;
  next.rotation = handed * Eigen::Quaterniond(Mat3(handed * next.rotation)).normalized().toRotationMatrix();
  return next;
}

// Variance a freedom has that the sample does not determine, mm^2: "anywhere on the part".
Mat6 covariance(const NormalEquations& system, const PartModel& model, const PartPose& T_camera_part, double sigma_mm) {
  const Vec6 scale = length_scale(model);
  const Mat6 scaled = scale.asDiagonal() * system.information * scale.asDiagonal();
  const double unknown_mm2 = model.diagonal_mm * model.diagonal_mm;
  const Mat6 prior = Mat6::Identity() * (sigma_mm * sigma_mm / unknown_mm2);
  const Mat6 inverse = (scaled + prior).ldlt().solve(Mat6::Identity()) * (sigma_mm * sigma_mm);
  const Mat6 in_part = scale.asDiagonal() * inverse * scale.asDiagonal();
  Mat6 to_camera = Mat6::Zero();
  to_camera.topLeftCorner<3, 3>() = T_camera_part.rotation;
  to_camera.bottomRightCorner<3, 3>() = T_camera_part.rotation;
  const Mat6 in_camera = to_camera * in_part * to_camera.transpose();
  return 0.5 * (in_camera + in_camera.transpose());
}

struct Outline {
  std::span<const OutlinePair> pairs;
  double weight;  // of each, where a point of the surface has 1
};

void describe_fit(const NormalEquations& system, std::size_t sample_size, Alignment& result) {
  result.rms_mm = std::sqrt(system.weighted_square / system.weight);
  result.inlier_share = static_cast<double>(system.inliers) / static_cast<double>(sample_size);
}

// Moves result.T_camera_part through all stages; false where too little of the sample is left near the part.
bool descend(std::span<const OrientedPoint> sample, const PartModel& model, std::span<const Stage> stages,
             const Outline& outline, Alignment& result) {
  const Vec6 scale = length_scale(model);
  for (const Stage& stage : stages) {
    for (int i = 0; i < stage.iterations; ++i) {
      const NormalEquations system =
          linearise(sample, model, result.T_camera_part, stage, outline.pairs, outline.weight);
      ++result.iterations;
      if (system.inliers < kLeastInliers) {
        result.rms_mm = result.inlier_share = 0.0;
        return false;
      }
      describe_fit(system, sample.size(), result);
      const Vec6 step = solve(system, scale);
      result.T_camera_part = moved(result.T_camera_part, step, model.centre_mm);
      const double moved_mm = step.cwiseQuotient(scale).norm();
      if (moved_mm < stage.settled * stage.radius_mm) break;
    }
  }
  return true;
}

}  // namespace

Alignment approach(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& initial,
                   std::span<const Stage> stages) {
  Alignment result;
  result.T_camera_part = initial;
  descend(sample, model, stages, {}, result);
  return result;
}

Alignment align(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& initial,
                std::span<const Stage> stages, const Noise& noise, std::span<const OutlinePair> outline) {
  Alignment result;
  result.T_camera_part = initial;
  const double ratio = noise.sigma_mm / noise.outline_sigma_mm;
  if (!descend(sample, model, stages, {outline, ratio * ratio}, result)) return result;
  const NormalEquations system = linearise(sample, model, result.T_camera_part, stages.back(), outline, ratio * ratio);
  if (system.inliers < kLeastInliers) return result;
  describe_fit(system, sample.size(), result);
  result.covariance = covariance(system, model, result.T_camera_part, std::max(noise.sigma_mm, result.rms_mm));
  return result;
}

}  // namespace beltpick::icp
