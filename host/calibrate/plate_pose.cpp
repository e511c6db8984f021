#include "calibrate/plate_pose.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace beltpick::calibrate {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kMaxSteps = 50;
constexpr double kStep_rad = 1e-6;  // of the differences that stand for derivatives
constexpr double kStep_mm = 1e-4;
constexpr double kConverged = 1e-10;

// A small turn about the plate's middle and a shift, after `pose`.
PlatePosition moved(const PlatePosition& pose, const Vector6& step) {
  const Vec3 turn = step.head<3>();
  PlatePosition result = pose;
  if (turn.norm() > 0.0) result.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.rotation;
  result.translation_mm += step.tail<3>();
  return result;
}

bool in_front(const Calibration& calibration, std::span<const SeenCorner> corners, const PlatePosition& pose) {
  for (const SeenCorner& corner : corners) {
    const Vec3 point_mm = pose * corner.plate_mm;
    if (point_mm.z() <= 0.0 || (calibration.T_projector_camera * point_mm).z() <= 0.0) return false;
  }
  return true;
}

CornerResidual residual_of(const Calibration& calibration, const SeenCorner& corner, const PlatePosition& pose) {
  const Vec3 point_mm = pose * corner.plate_mm;
  const PixelPosition seen = project(calibration.camera, point_mm);
  const PixelPosition lit = project(calibration.projector, calibration.T_projector_camera * point_mm);
  return {{corner.camera_px.column_px - seen.column_px, corner.camera_px.row_px - seen.row_px},
          {corner.projector_px.column_px - lit.column_px, corner.projector_px.row_px - lit.row_px}};
}

// All residuals in `views` below each other; those of an axis that is not coded are 0.
Eigen::VectorXd stacked(const Calibration& calibration, std::span<const SeenCorner> corners, Views views,
                        const PlatePosition& pose) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(4 * static_cast<Eigen::Index>(corners.size()));
  Eigen::Index at = 0;
  for (const SeenCorner& corner : corners) {
    const CornerResidual residual = residual_of(calibration, corner, pose);
    const auto put = [&](double value, bool wanted) { all[at++] = wanted && !std::isnan(value) ? value : 0.0; };
    put(residual.camera_px.column_px, views != Views::kProjector);
    put(residual.camera_px.row_px, views != Views::kProjector);
    put(residual.projector_px.column_px, views != Views::kCamera);
    put(residual.projector_px.row_px, views != Views::kCamera);
  }
  return all;
}

// One damped Gauss-Newton step.
Vector6 newton_step(const Calibration& calibration, std::span<const SeenCorner> corners, Views views,
                    const PlatePosition& pose, const Eigen::VectorXd& residuals, double damping) {
  Eigen::MatrixXd jacobian(residuals.size(), 6);
  for (int i = 0; i < 6; ++i) {
    Vector6 step = Vector6::Zero();
    step[i] = i < 3 ? kStep_rad : kStep_mm;
    jacobian.col(i) = (stacked(calibration, corners, views, moved(pose, step)) -
                       stacked(calibration, corners, views, moved(pose, Vector6(-step)))) /
                      (2.0 * step[i]);
  }
  Eigen::Matrix<double, 6, 6> normal = jacobian.transpose() * jacobian;
  normal.diagonal() *= 1.0 + damping;
  return normal.ldlt().solve(-(jacobian.transpose() * residuals));
}

}  // namespace

// Levenberg's and Marquardt's damping: ten times less after a step that helped, ten times more after one that did not.
std::optional<PlatePose> fit_plate_pose(const Calibration& calibration, std::span<const SeenCorner> corners,
                                        Views views, const PlatePosition& start) {
  if (corners.size() < 4 || !in_front(calibration, corners, start)) return std::nullopt;
  PlatePosition pose = start;
  Eigen::VectorXd residuals = stacked(calibration, corners, views, pose);
  double damping = 1e-4;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Vector6 step = newton_step(calibration, corners, views, pose, residuals, damping);
    if (!step.allFinite()) return std::nullopt;
    const PlatePosition next = moved(pose, step);
    const bool possible = in_front(calibration, corners, next);
    const Eigen::VectorXd after = possible ? stacked(calibration, corners, views, next) : residuals;
    if (!possible || after.squaredNorm() > residuals.squaredNorm()) {
      if (step.norm() < 1e-6 || damping > 1e6) break;
      damping *= 10.0;
      continue;
    }
    const double gain = residuals.squaredNorm() - after.squaredNorm();
    pose = next;
    residuals = after;
    damping = std::max(1e-9, damping / 10.0);
    if (gain <= kConverged * residuals.squaredNorm() + kConverged * kConverged) break;
  }
  PlatePose fitted{pose, {}};
  for (const SeenCorner& corner : corners) fitted.residuals.push_back(residual_of(calibration, corner, pose));
  return fitted;
}

}  // namespace beltpick::calibrate
