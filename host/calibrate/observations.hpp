// What calibration starts from: where camera and projector see the printed corners of the plate, capture by capture.
// Small enough to be kept beside the result, so that a calibration can be repeated without its captures.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/pose.hpp"
#include "contract/capture.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::calibrate {

// The printed pattern. Chessboard: columns x rows inner corners. ChArUco: the same, with markers in the white squares.
struct Board {
  int columns = 0, rows = 0;
  double square_mm = 0.0;
  double marker_mm = 0.0;       // of ChArUco; 0: a chessboard
  std::string dictionary = {};  // of ChArUco, as OpenCV names it: DICT_4X4_50 ...

  [[nodiscard]] bool is_charuco() const { return marker_mm > 0.0; }
  [[nodiscard]] int corners() const { return columns * rows; }
  [[nodiscard]] int column_of(int corner) const { return corner % columns; }
  [[nodiscard]] int row_of(int corner) const { return corner / columns; }
  // In the plate's frame: origin at the first inner corner, x along its columns, y along its rows, z into the plate.
  [[nodiscard]] Vec3 flat_mm(int corner) const {
    return {column_of(corner) * square_mm, row_of(corner) * square_mm, 0.0};
  }
};

// One corner as one capture shows it.
struct ObservedCorner {
  int corner = 0;  // row * columns + column
  PixelPosition camera_px;
  // The projector coordinate on the plate at camera_px; NaN where there is none.
  PixelPosition projector_px{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  // How it changes from camera pixel to camera pixel: d (column, row) / d (camera column, row).
  Eigen::Matrix2d projector_by_camera = Eigen::Matrix2d::Zero();
  double projector_sigma_px = 0.0;  // predicted, of projector_px at camera_px
  std::string no_projector_reason;  // where projector_px is NaN

  [[nodiscard]] bool has_projector() const { return no_projector_reason.empty(); }
};

struct ObservedPose {
  std::string capture;  // its id
  std::vector<ObservedCorner> corners;
};

// Something left out, and why. corner < 0: the whole capture.
struct LeftOut {
  std::string capture;
  int corner = -1;
  std::string reason;
  double residual_px = 0.0;  // where it was its residual
};

struct Observations {
  Board board;
  int camera_width = 0, camera_height = 0;
  ProjectorGrid projector;
  std::vector<ObservedPose> poses;
  std::vector<LeftOut> left_out;  // captures in which no plate was found
};

}  // namespace beltpick::calibrate
