// A rig with distorting lenses, and a plate as it sees it without noise.
#pragma once

#include <cmath>
#include <vector>

#include "calibrate/plate_pose.hpp"
#include "contract/calibration.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::test {

// Camera and projector 390 mm apart, aimed at a point 700 mm before the camera.
inline Calibration sample_rig() {
  Calibration rig;
  rig.id = "sample";
  rig.camera = {1280, 960, 2240.0, 2241.0, 645.0, 476.0, {-0.146, 0.114, 0.0005, -0.0004, 0.07}};
  rig.projector = {912, 1140, 1607.0, 2414.0, 459.0, 575.0, {0.136, 0.138, -0.0009, -0.0003, -0.99}};
  const double angle_rad = -0.523;
  const Mat3 turn = Eigen::AngleAxisd(angle_rad, Vec3::UnitY()).toRotationMatrix();
  const Vec3 target_mm(0.0, 0.0, 700.0);
  rig.T_projector_camera = {turn, Vec3(0.0, 0.0, 780.0) - turn * target_mm};
  return rig;
}

// The plate's 11x8 corners 20 mm apart, about its middle.
inline std::vector<Vec3> sample_corners_mm() {
  std::vector<Vec3> corners_mm;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 11; ++column) corners_mm.emplace_back(20.0 * column, 20.0 * row, 0.0);
  }
  return corners_mm;
}

// Tilted, before the camera.
inline Pose<frame::Camera, frame::Part> sample_pose() {
  Pose<frame::Camera, frame::Part> pose;
  pose.rotation = (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(-0.2, Vec3::UnitY())).toRotationMatrix();
  pose.translation_mm = Vec3(0.0, 0.0, 690.0) - pose.rotation * Vec3(100.0, 70.0, 0.0);
  return pose;
}

inline std::vector<calibrate::SeenCorner> seen_by(const Calibration& rig,
                                                  const Pose<frame::Camera, frame::Part>& pose) {
  std::vector<calibrate::SeenCorner> seen;
  for (const Vec3& plate_mm : sample_corners_mm()) {
    const Vec3 point_mm = pose * plate_mm;
    seen.push_back(
        {plate_mm, project(rig.camera, point_mm), project(rig.projector, rig.T_projector_camera * point_mm)});
  }
  return seen;
}

}  // namespace beltpick::test
