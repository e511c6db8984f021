// The cell's geometry: calibration.json and cell.json. OpenCV's camera model; millimetres.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "base/pose.hpp"

namespace beltpick {

// OpenCV's pinhole with five distortion parameters k1, k2, p1, p2, k3; pixel centres at integers; no skew.
struct Lens {
  int width = 0, height = 0;
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  std::array<double, 5> distortion{};

  friend bool operator==(const Lens&, const Lens&) = default;
};

struct Calibration {
  std::string id;
  std::string camera_serial;     // empty where not told
  std::string projector_serial;  // empty where not told
  Lens camera;
  Lens projector;
  Pose<frame::Projector, frame::Camera> T_projector_camera;  // X_projector = R X_camera + t

  friend bool operator==(const Calibration&, const Calibration&) = default;
};

struct Cell {
  std::string calibration_id;
  std::optional<Pose<frame::Belt, frame::Camera>> T_belt_camera;
  std::optional<Pose<frame::Robot, frame::Camera>> T_robot_camera;
};

}  // namespace beltpick
