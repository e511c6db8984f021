// The joint refinement: both lenses, the way from camera to projector, the plate's pose in each capture and its shape,
// by least squares over all corners.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "calibrate/observations.hpp"
#include "calibrate/plate_position.hpp"
#include "contract/calibration.hpp"

namespace beltpick::calibrate {

// What is refined. Poses as many as the observations have; those not used keep theirs.
struct BundleState {
  Calibration rig;
  std::vector<PlatePosition> T_camera_plate;
  std::vector<double> height_mm;  // by corner of the board: out of the printed side

  [[nodiscard]] Vec3 plate_mm(const Board& board, int corner) const {
    const Vec3 flat_mm = board.flat_mm(corner);
    return {flat_mm.x(), flat_mm.y(), -height_mm[static_cast<std::size_t>(corner)]};
  }
};

// Which observations take part: by pose, and by corner in each pose.
struct Selection {
  std::vector<bool> pose;
  std::vector<std::vector<bool>> corner;     // the corner at all
  std::vector<std::vector<bool>> projector;  // its projector coordinate

  [[nodiscard]] bool has(std::size_t p, std::size_t i) const { return pose[p] && corner[p][i]; }
};

// The noise by which residuals are weighed.
struct BundleNoise {
  double camera_px = 0.1;
  double projector_px = 0.1;
};

// Observed - predicted. The projector's is that of the light at the place where the model puts the corner in the
// camera image: projector_px + projector_by_camera * (predicted - observed camera pixel) - predicted.
struct BundleResidual {
  Eigen::Vector2d camera_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d projector_px = Eigen::Vector2d::Zero();
};
BundleResidual residual_of(const Observations& seen, const BundleState& state, std::size_t pose, std::size_t corner);

struct BundleOptions {
  int max_steps = 40;
  bool plate_shape = true;  // refine the heights; else they stay
};

struct BundleResult {
  BundleState state;
  bool converged = false;
  Eigen::MatrixXd information;  // the normal matrix at the end; its inverse is the parameters' covariance
};

// Where the rig's parameters stand in the information matrix: camera 9, projector 9 (as LensVector), then turn (rad)
// and shift (mm) of the way from camera to projector.
inline constexpr int kRigParameters = 24;
// `rig` changed by `step` (kRigParameters numbers).
Calibration moved_rig(const Calibration& rig, const Eigen::VectorXd& step);

// Levenberg's and Marquardt's method with Huber's loss on each corner of each view. Weak priors keep what the captures
// do not tell near to what lenses are like: small distortion, a plate that bends smoothly.
BundleResult refine(const Observations& seen, const Selection& use, const BundleNoise& noise, BundleState start,
                    const BundleOptions& options = {});

// Standard deviations of the rig's parameters and of the heights, from the information matrix.
struct BundleSigmas {
  Eigen::MatrixXd rig_covariance;  // kRigParameters square
  std::vector<double> height_mm;   // by corner
};
BundleSigmas sigmas_of(const Observations& seen, const BundleResult& result);

}  // namespace beltpick::calibrate
