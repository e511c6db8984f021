// Everything that a calibration found out: the geometry, how good it is, by pose and by corner, and what was left out.
// The JSON, the report and the words on the terminal are made of this alone.
#pragma once

#include <string>
#include <vector>

#include "calibrate/observations.hpp"
#include "calibrate/plate_position.hpp"
#include "contract/calibration.hpp"

namespace beltpick::calibrate {

// A corner in one pose. Residuals are observed - predicted; the projector's is that of the light on the plate where the
// camera's model puts the corner, so that an error of the corner in the camera image is not counted twice.
struct CornerOutcome {
  int corner = 0;
  PixelPosition camera_px;     // observed
  PixelPosition projector_px;  // observed; NaN where the projector's light was not measured
  PixelPosition camera_residual_px;
  PixelPosition projector_residual_px;
  bool used = true;    // in the solution
  std::string reason;  // where not
};

struct PoseOutcome {
  std::string capture;
  bool used = true;
  std::string reason;  // where not
  PlatePosition T_camera_plate;
  double distance_mm = 0.0;                            // of its middle along the camera's axis
  double tilt_x_deg = 0.0, tilt_y_deg = 0.0;           // of its normal: up or down (about the image's x), left or right
  double camera_rms_px = 0.0, projector_rms_px = 0.0;  // of used corners, 2-D as OpenCV counts
  double stereo_rms_px = 0.0;                          // across the baseline: what the two views disagree by
  // Measured by a calibration made without this pose: the corners against the plate laid through them.
  bool held_out = false;  // measured
  double held_out_rms_mm = 0.0, held_out_max_mm = 0.0;
  double held_out_size_ppm = 0.0;  // by which the plate looks too large
  std::vector<CornerOutcome> corners;
};

// How often a field of the view was covered by a used corner: rows x columns, row after row from the upper left.
struct CoverageGrid {
  int columns = 0, rows = 0;
  std::vector<int> counts;

  [[nodiscard]] double share() const {  // of the fields that hold one
    int filled = 0;
    for (const int count : counts) filled += count > 0 ? 1 : 0;
    return counts.empty() ? 0.0 : static_cast<double>(filled) / static_cast<double>(counts.size());
  }
};

struct Coverage {
  CoverageGrid camera, projector;
  double near_mm = 0.0, far_mm = 0.0;  // of used corners along the camera's axis
  double tilt_x_range_deg = 0.0;       // between the outermost plates, about the image's x axis
  double tilt_y_range_deg = 0.0;       // about y
  std::vector<int> depth_counts;       // of used corners, in equal steps from near to far
};

struct ParameterOutcome {
  std::string name;  // "camera fx" ...
  std::string unit;  // "px", "mm", "deg", ""
  double value = 0.0;
  double sigma = 0.0;  // standard deviation that the residuals imply
};

// The plate as it really is: height of each corner out of its printed side, mm; no offset, no tilt.
struct PlateShape {
  std::vector<double> height_mm;  // by corner
  std::vector<double> sigma_mm;
  double peak_to_valley_mm = 0.0;
  bool symmetric = false;  // the board looks the same turned by 180 degrees: only the part common to both ways is known
};

enum class Grade { kGood, kUsable, kPoor };
inline constexpr const char* kGradeNames[] = {"good", "usable", "poor"};

struct Outcome {
  Calibration calibration;
  Board board;
  std::vector<PoseOutcome> poses;  // in the order of the captures; also those not used
  std::vector<LeftOut> left_out;   // captures and corners, with the reason; all of them
  PlateShape plate;
  Coverage coverage;
  std::vector<ParameterOutcome> parameters;
  int poses_used = 0, corners_used = 0, corners_left_out = 0;
  double camera_rms_px = 0.0, projector_rms_px = 0.0, stereo_rms_px = 0.0;
  double held_out_rms_mm = 0.0, held_out_max_mm = 0.0;  // over all poses held out
  double held_out_size_ppm = 0.0;                       // rms
  // Standard deviation of a measured point over the volume covered, from the parameters' covariance: rms and worst.
  double point_sigma_mm = 0.0, point_sigma_max_mm = 0.0;
  Grade grade = Grade::kGood;
  std::vector<std::string> verdict;  // sentences: what is good, what is not and what to capture next
};

}  // namespace beltpick::calibrate
