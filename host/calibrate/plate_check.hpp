// The field check of a calibration: one capture of the plate, measured with it, against what is known of the plate.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "calibrate/observations.hpp"
#include "calibrate/plate_pose.hpp"

namespace beltpick::calibrate {

// What is good enough. The figures of a sound calibration of the default rig are a tenth of these, the bow of a plate
// apart; a drift by 0.05 pixels between camera and projector, a quarter of a millimetre of depth, exceeds them.
struct PlateTolerance {
  double local_mm = 0.05;  // rms: distances of neighbouring corners, corners to the plane
  double plate_mm = 0.10;  // over the plate: its size, its bow, its distance, where camera and projector see it
};

// A corner measured as the appliance measures: a ray of the camera and one projector coordinate.
struct MeasuredCorner {
  Vec3 plate_mm;          // where it belongs on the plate
  Vec3 point_mm;          // measured, camera frame
  double above_mm = 0.0;  // above the plane through all, towards the camera
  CornerResidual residual;
};

// One line of the verdict: a measured figure and what it may be.
struct CheckedFigure {
  std::string name;     // for machines
  std::string meaning;  // for people
  double value_mm = 0.0;
  double limit_mm = 0.0;

  [[nodiscard]] bool good() const { return value_mm <= limit_mm; }
};

struct PlateCheck {
  std::vector<MeasuredCorner> corners;
  std::vector<CheckedFigure> figures;
  PlatePosition T_camera_plate;    // where both views see the plate
  double size_error_mm = 0.0;      // measured - true, over the diagonal of what is seen; signed
  double distance_error_mm = 0.0;  // of the plate from the camera, measured - what its size in the image says; signed
  double distance_mm = 0.0;        // of its middle
  double tilt_deg = 0.0;           // against the camera's image
  double camera_rms_px = 0.0, projector_rms_px = 0.0;
  PixelPosition projector_shift_px;  // mean residual of the projector against the camera's pose of the plate

  [[nodiscard]] bool good() const;
  // What is farthest out of tolerance and how much else is, or that nothing is; one sentence.
  [[nodiscard]] std::string verdict() const;
};

// The corners of one capture that have a projector coordinate, on a flat plate.
std::vector<SeenCorner> seen_corners(const Board& board, const ObservedPose& pose);

// Measures `corners` with `calibration`. `square_mm` tells which corners are neighbours. Errors: kTooFewPoints (fewer
// than 12 corners can be measured, or they lie on one line), kCalibrationMismatch (they cannot be one plate in front of
// this rig).
Result<PlateCheck> check_plate(const Calibration& calibration, std::span<const SeenCorner> corners, double square_mm,
                               const PlateTolerance& tolerance);

}  // namespace beltpick::calibrate
