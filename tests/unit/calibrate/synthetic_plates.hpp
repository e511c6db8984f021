// Plates as a known rig sees them, exactly: what calibration must find again.
#pragma once

#include <cmath>
#include <string>

#include "base/random.hpp"
#include "calibrate/observations.hpp"
#include "contract/lens_project.hpp"
#include "sample_rig.hpp"

namespace beltpick::test {

struct PlateSet {
  int poses = 10;
  double tilt_rad = 0.45;  // most about each axis
  double shift_mm = 60.0;  // most to each side
  double depth_mm = 60.0;  // most nearer and farther than 650 mm
  double bend_mm = 0.0;    // of the plate's ends against its middle
  double noise_px = 0.0;   // standard deviation in both images
  int columns = 11, rows = 8;
  std::uint64_t seed = 1;
};

inline double normal_deviate(Random& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

// Height out of the printed side: a cylinder's arc along x, mean and tilt zero.
inline double bent_mm(const PlateSet& set, int column) {
  const double x = 2.0 * column / (set.columns - 1) - 1.0;
  const double mean = (set.columns + 1.0) / (3.0 * (set.columns - 1.0));  // of x^2 over the columns
  return set.bend_mm * (x * x - mean);
}

inline Pose<frame::Camera, frame::Part> random_pose(const PlateSet& set, const calibrate::Board& board,
                                                    Random& random) {
  Pose<frame::Camera, frame::Part> pose;
  const auto tilt = [&] { return random.uniform(-set.tilt_rad, set.tilt_rad); };
  pose.rotation = (Eigen::AngleAxisd(tilt(), Vec3::UnitX()) * Eigen::AngleAxisd(tilt(), Vec3::UnitY()) *
                   Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Vec3::UnitZ()))
                      .toRotationMatrix();
  const Vec3 middle_mm(0.5 * (board.columns - 1) * board.square_mm, 0.5 * (board.rows - 1) * board.square_mm, 0.0);
  const Vec3 at_mm(random.uniform(-set.shift_mm, set.shift_mm), random.uniform(-set.shift_mm, set.shift_mm),
                   650.0 + random.uniform(-set.depth_mm, set.depth_mm));
  pose.translation_mm = at_mm - pose.rotation * middle_mm;
  return pose;
}

inline calibrate::ObservedCorner observe(const Calibration& rig, const Pose<frame::Camera, frame::Part>& pose,
                                         const Vec3& plate_mm, int corner) {
  constexpr double kStep_mm = 0.01;
  calibrate::ObservedCorner seen;
  seen.corner = corner;
  const auto images = [&](const Vec3& at_mm) {
    const Vec3 point_mm = pose * at_mm;
    const PixelPosition camera = project(rig.camera, point_mm);
    const PixelPosition light = project(rig.projector, rig.T_projector_camera * point_mm);
    return Eigen::Vector4d(camera.column_px, camera.row_px, light.column_px, light.row_px);
  };
  const Eigen::Vector4d at = images(plate_mm);
  Eigen::Matrix<double, 4, 2> by;
  by.col(0) = (images(plate_mm + kStep_mm * Vec3::UnitX()) - at) / kStep_mm;
  by.col(1) = (images(plate_mm + kStep_mm * Vec3::UnitY()) - at) / kStep_mm;
  seen.camera_px = {at[0], at[1]};
  seen.projector_px = {at[2], at[3]};
  seen.projector_by_camera = by.bottomRows<2>() * by.topRows<2>().inverse();
  seen.projector_sigma_px = 0.001;
  return seen;
}

inline calibrate::Observations observe_plates(const Calibration& rig, const PlateSet& set) {
  calibrate::Observations seen;
  seen.board = {set.columns, set.rows, 20.0};
  seen.camera_width = rig.camera.width;
  seen.camera_height = rig.camera.height;
  seen.projector = {rig.projector.width, rig.projector.height};
  Random random(set.seed);
  for (int p = 0; p < set.poses; ++p) {
    const auto pose = random_pose(set, seen.board, random);
    calibrate::ObservedPose observed{"pose" + std::to_string(p), {}};
    for (int corner = 0; corner < seen.board.corners(); ++corner) {
      Vec3 plate_mm = seen.board.flat_mm(corner);
      plate_mm.z() = -bent_mm(set, seen.board.column_of(corner));
      auto one = observe(rig, pose, plate_mm, corner);
      // The corner is found with an error; the light is what stands at the place found.
      const Eigen::Vector2d off = set.noise_px * Eigen::Vector2d(normal_deviate(random), normal_deviate(random));
      const Eigen::Vector2d light = one.projector_by_camera * off;
      one.camera_px = {one.camera_px.column_px + off.x(), one.camera_px.row_px + off.y()};
      one.projector_px = {one.projector_px.column_px + light.x() + 0.1 * set.noise_px * normal_deviate(random),
                          one.projector_px.row_px + light.y() + 0.1 * set.noise_px * normal_deviate(random)};
      observed.corners.push_back(one);
    }
    seen.poses.push_back(std::move(observed));
  }
  return seen;
}

}  // namespace beltpick::test
