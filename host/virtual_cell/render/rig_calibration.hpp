// The calibration of a rig: the five-parameter model that a good calibration would find for its richer lenses.
#pragma once

#include "contract/calibration.hpp"
#include "virtual_cell/render/rig.hpp"

namespace beltpick::virtual_cell {

struct RigCalibration {
  Calibration calibration;
  double camera_rms_px = 0.0;  // what the simpler model leaves, over the image
  double projector_rms_px = 0.0;
};

// Fits focal lengths, principal point and k1, k2, p1, p2, k3 of each lens by least squares on points through the
// working volume. The camera frame and the projector's pose stay the true ones, so that truth and measurement share it.
RigCalibration calibrate_rig(const Rig& rig);

// cell.json of a rig, tied to the calibration.
Cell make_cell(const Rig& rig, const Calibration& calibration);

}  // namespace beltpick::virtual_cell
