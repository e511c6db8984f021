// Where a plate with known corners lies, from where camera and projector see the corners, the calibration held fixed.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrate/plate_position.hpp"
#include "contract/calibration.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::calibrate {

// A corner of the plate as seen in one capture.
struct SeenCorner {
  Vec3 plate_mm = Vec3::Zero();  // in the plate's frame: x along its columns, y along its rows, z into the plate
  PixelPosition camera_px;
  PixelPosition projector_px;  // the coordinate of an axis that is not coded is NaN
};

// What the pose leaves, seen - predicted.
struct CornerResidual {
  PixelPosition camera_px, projector_px;
};

enum class Views { kCamera, kProjector, kBoth };

struct PlatePose {
  PlatePosition T_camera_plate;
  std::vector<CornerResidual> residuals;  // a corner each, of both views whatever was fitted
};

// The pose with the least squared residuals in `views`, from `start`. Nothing where it does not converge in front of
// both lenses, or where fewer than four corners are given.
std::optional<PlatePose> fit_plate_pose(const Calibration& calibration, std::span<const SeenCorner> corners,
                                        Views views, const PlatePosition& start);

}  // namespace beltpick::calibrate
