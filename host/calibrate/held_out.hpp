// Poses held out: a calibration made without one of them measures its plate, as the appliance would.
#pragma once

#include <functional>
#include <optional>

#include "calibrate/bundle.hpp"

namespace beltpick::calibrate {

// What a calibration makes of one pose's plate.
struct MeasuredPlate {
  double rms_mm = 0.0, max_mm = 0.0;  // of the corners against the plate laid through them
  double size_ppm = 0.0;              // by which it measures too large
  int corners = 0;
};

// Triangulates the used corners of `pose` by the camera's ray and the projector's axis across the baseline, and lays
// the plate (state's heights) through them. Nothing where fewer than six corners can be measured.
std::optional<MeasuredPlate> measure_plate(const Observations& seen, const Selection& use, const BundleState& state,
                                           std::size_t pose);

// Leaves each used pose out in turn, refines the rest from `state`, and measures it. By pose; nothing for those not
// used. `done` is called after each.
std::vector<std::optional<MeasuredPlate>> hold_poses_out(const Observations& seen, const Selection& use,
                                                         const BundleNoise& noise, const BundleState& state,
                                                         const BundleOptions& options,
                                                         const std::function<void()>& done);

// How far measured points vary with the parameters' uncertainty: standard deviation over the corners used, after the
// best rigid motion, which measuring never notices.
struct PointSigma {
  double rms_mm = 0.0, max_mm = 0.0;
};
PointSigma point_sigma(const Observations& seen, const Selection& use, const BundleState& state,
                       const Eigen::MatrixXd& rig_covariance);

}  // namespace beltpick::calibrate
