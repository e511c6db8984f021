// How far apart two calibrations of one rig measure: what the new one makes of exactly the light and pixels that the
// old one calls a point, over the belt and over the volume above it.
#pragma once

#include <optional>
#include <vector>

#include "base/result.hpp"
#include "calibrate/rigid_fit.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::calibrate {

struct CompareOptions {
  std::optional<double> distance_mm;  // of the belt along the camera's axis, where no cell tells it and none is guessed
  double height_mm = 100.0;           // of the volume above the belt
  int columns = 33, rows = 25;        // of the grid of camera pixels, at
  int layers = 6;                     // heights
};

// Distances between what both make of the same measurement, in mm.
struct Spread {
  double rms_mm = 0.0;
  double max_mm = 0.0;
  int points = 0;
};

struct ComparedPoint {
  PixelPosition camera_px;
  Vec3 old_mm, new_mm;  // camera frame
  int layer = 0;        // 0 is the belt
};

struct Comparison {
  Axis axis = Axis::kColumn;              // whose codes were triangulated: the old one's sensitive_axis
  double distance_mm = 0.0;               // of the belt's centre from the camera
  double height_mm = 0.0;                 // of the volume above it
  bool distance_guessed = false;          // from where the two images' centres meet
  int image_width = 0, image_height = 0;  // of the camera
  PixelPosition grid_step_px;             // between neighbours of `points`
  std::vector<ComparedPoint> points;
  Spread belt, volume;              // as they stand
  RigidFit motion;                  // takes what the new one measures to what the old one does, best over the volume
  Spread belt_moved, volume_moved;  // what is left after that motion
};

// `cell`, where given, tells the belt's plane (belt z = 0); else a plane square to the camera at `distance_mm`, else at
// crossing_depth_mm. Errors: kCalibrationMismatch (image sizes differ), kTooFewPoints (the two images share too little
// of the belt, or no distance can be guessed).
Result<Comparison> compare(const Calibration& old_calibration, const Calibration& new_calibration,
                           const std::optional<Cell>& cell, const CompareOptions& options);

}  // namespace beltpick::calibrate
