// Depth from one projector axis, a row of camera pixels at a time. Internal to range.
#pragma once

#include <array>
#include <cstdint>

#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"

namespace beltpick::range {

// The projector seen along one of its axes: s is the coded coordinate, o the other one.
struct AxisModel {
  std::array<float, 3> rotation_s{}, rotation_o{}, rotation_z{};  // rows of the rotation camera -> projector
  float translation_s = 0.0F, translation_o = 0.0F, translation_z = 0.0F;
  float focal_s = 1.0F, centre_s = 0.0F, focal_o = 1.0F, centre_o = 0.0F;
  float k1 = 0.0F, k2 = 0.0F, k3 = 0.0F;
  float tangential_so = 0.0F;  // of 2 s o in s: p1 for columns, p2 for rows
  float tangential_ss = 0.0F;  // of r^2 + 2 s^2 in s
};

AxisModel axis_model(const Calibration& calibration, Axis axis);

// For rays (u, v, 1) in the camera frame and codes of the axis. A camera ray is a straight line in the projector's
// ideal coordinates: o = offset + slope s. Newton's method finds the s on it whose distorted image is the code; then
// z = (t_s - s t_z) / (s q_z - q_s), q the rotated ray. Holds at any working distance.
//   depth_mm   camera z; 0 where there is none (NaN codes, points behind a lens)
//   mm_per_px  |d z / d code|
//   other_px   the projector coordinate along the other axis that follows
void depth_row(const AxisModel& model, const float* ray_u, const float* ray_v, const float* code_px, int count,
               float* depth_mm, float* mm_per_px, float* other_px);

// The noise to expect of a row of codes: sigma_px as CodeNoise says, sigma_mm = sigma_px * mm_per_px. Depths whose
// other_px lies more than slack_px outside the other axis' extent, where the projector lights nothing, become 0.
void judge_row(const CodeNoise& noise, const float* modulation, const std::uint8_t* texture, const float* mm_per_px,
               const float* other_px, int other_extent_px, float slack_px, int count, float* depth_mm, float* sigma_px,
               float* sigma_mm);

// point_mm = depth ray; sigma along the ray; both 0 where the depth is 0. Returns the number of points.
int point_row(const float* ray_u, const float* ray_v, const float* depth_mm, const float* sigma_depth_mm, int count,
              float* point_mm, float* sigma_mm);

}  // namespace beltpick::range
