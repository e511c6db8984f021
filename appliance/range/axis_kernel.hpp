// Depth from one projector axis, a row of camera pixels at a time. Internal to range.
#pragma once

#include <array>
#include <cstdint>

#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"

namespace beltpick::range {

// The projector seen along one of its axes: s is the coded coordinate, o the other one. Rays (u, v, 1) of the camera
// enter by linear forms, so that a pixel costs as few operations as can be.
struct AxisModel {
  using Form = std::array<float, 3>;  // f(u, v) = f0 u + f1 v + f2
  Form ray_s{}, ray_z{};              // the rotated ray q along s and z
  // A camera ray is the straight line o = (offset + slope s) / across in the projector's ideal coordinates.
  Form across{}, offset{}, slope{};
  float translation_s = 0.0F, translation_z = 0.0F;
  float focal_s = 1.0F, centre_s = 0.0F, focal_o = 1.0F, centre_o = 0.0F;
  float other_extent_px = 0.0F;  // of the projector along o
  float k1 = 0.0F, k2 = 0.0F, k3 = 0.0F;
  float tangential_so = 0.0F;  // of 2 s o in s: p1 for columns, p2 for rows
  float tangential_ss = 0.0F;  // of r^2 + 2 s^2 in s
  bool strong_lens = true;     // takes four of Newton's steps instead of one: always right, twice as slow
};

AxisModel axis_model(const Calibration& calibration, Axis axis);

// How far, in projector pixels, codes may stand from where the geometry puts them: calibration error and lens residue.
inline constexpr float kModelSlackPx = 3.0F;

// What a row's pixels tell the kernels.
struct AxisInput {
  const float *ray_u, *ray_v;  // NaN: no ray
  const float* code_px;        // NaN: no code
  const float* modulation;     // grey levels scaled to 8 bits
  const std::uint8_t* texture;
  CodeNoise noise;
};

// The straight line of a pixel's ray meets the code where the line's distorted image is the code: Newton's method finds
// s, then z = (t_s - s t_z) / (s q_z - q_s). Holds at any working distance.
//   depth_mm  camera z; 0 where there is none: NaN codes, points behind a lens, other coordinates more than
//             kModelSlackPx outside the other axis' extent, where the projector lights nothing
//   sigma_mm  the standard deviation to expect along the ray: sigma_px as CodeNoise says, times |d z / d code|, times
//             the ray's length at z = 1; any number where there is no depth
void depth_row(const AxisModel& model, const AxisInput& in, int count, float* depth_mm, float* sigma_mm);

// The same, with what it takes to compare both axes of a row.
//   other_px  the projector coordinate along the other axis that follows
//   sigma_px  of the code
void depth_row(const AxisModel& model, const AxisInput& in, int count, float* depth_mm, float* sigma_mm,
               float* other_px, float* sigma_px);

}  // namespace beltpick::range
