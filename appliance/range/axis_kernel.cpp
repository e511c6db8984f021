#include "range/axis_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"

namespace beltpick::range {

AxisModel axis_model(const Calibration& calibration, Axis axis) {
  const bool column = axis == Axis::kColumn;
  const int s = column ? 0 : 1;
  const Lens& lens = calibration.projector;
  const auto& pose = calibration.T_projector_camera;
  AxisModel model;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    model.rotation_s[at] = static_cast<float>(pose.rotation(s, i));
    model.rotation_o[at] = static_cast<float>(pose.rotation(1 - s, i));
    model.rotation_z[at] = static_cast<float>(pose.rotation(2, i));
  }
  model.translation_s = static_cast<float>(pose.translation_mm[s]);
  model.translation_o = static_cast<float>(pose.translation_mm[1 - s]);
  model.translation_z = static_cast<float>(pose.translation_mm[2]);
  model.focal_s = static_cast<float>(column ? lens.fx_px : lens.fy_px);
  model.centre_s = static_cast<float>(column ? lens.cx_px : lens.cy_px);
  model.focal_o = static_cast<float>(column ? lens.fy_px : lens.fx_px);
  model.centre_o = static_cast<float>(column ? lens.cy_px : lens.cx_px);
  model.k1 = static_cast<float>(lens.distortion[0]);
  model.k2 = static_cast<float>(lens.distortion[1]);
  model.k3 = static_cast<float>(lens.distortion[4]);
  model.tangential_so = static_cast<float>(lens.distortion[column ? 2 : 3]);
  model.tangential_ss = static_cast<float>(lens.distortion[column ? 3 : 2]);
  return model;
}

BELTPICK_KERNEL
void depth_row(const AxisModel& model, const float* __restrict ray_u, const float* __restrict ray_v,
               const float* __restrict code_px, int count, float* __restrict depth_mm, float* __restrict mm_per_px,
               float* __restrict other_px) {
  const AxisModel m = model;
  constexpr int kSteps = 4;  // from the undistorted guess; each squares the error
  constexpr float kConvergedPx = 0.005F;
  for (int i = 0; i < count; ++i) {
    const float u = ray_u[i];
    const float v = ray_v[i];
    const float q_s = m.rotation_s[0] * u + m.rotation_s[1] * v + m.rotation_s[2];
    const float q_o = m.rotation_o[0] * u + m.rotation_o[1] * v + m.rotation_o[2];
    const float q_z = m.rotation_z[0] * u + m.rotation_z[1] * v + m.rotation_z[2];
    const float across = m.translation_z * q_s - m.translation_s * q_z;
    const float slope = (m.translation_z * q_o - m.translation_o * q_z) / across;
    const float offset = (m.translation_o * q_s - m.translation_s * q_o) / across;
    const float seen = (code_px[i] - m.centre_s) / m.focal_s;
    float s = seen;
    float gradient = 1.0F;
    float miss = 0.0F;
    float o = 0.0F;
    float radial = 1.0F;
    float r2 = 0.0F;
#pragma GCC unroll 4  // before vectorisation, which takes no inner loops
    for (int step = 0; step < kSteps; ++step) {
      o = offset + slope * s;
      r2 = s * s + o * o;
      radial = 1.0F + r2 * (m.k1 + r2 * (m.k2 + r2 * m.k3));
      const float bend = m.k1 + r2 * (2.0F * m.k2 + r2 * 3.0F * m.k3);
      const float along_s = radial + 2.0F * s * s * bend + 2.0F * m.tangential_so * o + 6.0F * m.tangential_ss * s;
      const float along_o = 2.0F * (s * o * bend + m.tangential_so * s + m.tangential_ss * o);
      miss = s * radial + 2.0F * m.tangential_so * s * o + m.tangential_ss * (r2 + 2.0F * s * s) - seen;
      gradient = along_s + slope * along_o;
      s -= miss / gradient;
    }
    o = offset + slope * s;
    const float denominator = s * q_z - q_s;
    const float z = (m.translation_s - s * m.translation_z) / denominator;
    const float z_projector = z * q_z + m.translation_z;
    const bool good = (std::fabs(miss) * m.focal_s < kConvergedPx) & (z > 0.0F) & (z_projector > 0.0F) & (z < 1e6F);
    depth_mm[i] = good ? z : 0.0F;
    mm_per_px[i] = std::fabs(across / (denominator * denominator * gradient * m.focal_s));
    other_px[i] =
        (o * radial + 2.0F * m.tangential_ss * s * o + m.tangential_so * (r2 + 2.0F * o * o)) * m.focal_o + m.centre_o;
  }
}

BELTPICK_KERNEL
void judge_row(const CodeNoise& noise, const float* __restrict modulation, const std::uint8_t* __restrict texture,
               const float* __restrict mm_per_px, const float* __restrict other_px, int other_extent_px, float slack_px,
               int count, float* __restrict depth_mm, float* __restrict sigma_px, float* __restrict sigma_mm) {
  const float first_px = -0.5F - slack_px;
  const float last_px = static_cast<float>(other_extent_px) - 0.5F + slack_px;
  const float floor_squared = noise.floor_px * noise.floor_px;
  const float slope_squared = noise.slope_px * noise.slope_px;
  for (int i = 0; i < count; ++i) {
    // The texture is what white light shows; a fringe's mean is half of it.
    const float level_variance =
        kCameraNoise.floor_variance + kCameraNoise.shot_variance_per_level * (0.5F * static_cast<float>(texture[i]));
    const float amplitude = std::max(modulation[i], 1e-3F);
    const float sigma = std::sqrt(floor_squared + slope_squared * level_variance / (amplitude * amplitude));
    const bool lit = (other_px[i] > first_px) & (other_px[i] < last_px);
    depth_mm[i] = lit ? depth_mm[i] : 0.0F;
    sigma_px[i] = sigma;
    sigma_mm[i] = sigma * mm_per_px[i];
  }
}

BELTPICK_KERNEL
int point_row(const float* __restrict ray_u, const float* __restrict ray_v, const float* __restrict depth_mm,
              const float* __restrict sigma_depth_mm, int count, float* __restrict point_mm,
              float* __restrict sigma_mm) {
  int points = 0;
  for (int i = 0; i < count; ++i) {
    const float z = depth_mm[i];
    const bool measured = z > 0.0F;
    const float u = measured ? ray_u[i] : 0.0F;  // a pixel without a ray has NaN
    const float v = measured ? ray_v[i] : 0.0F;
    point_mm[3 * i] = u * z;
    point_mm[3 * i + 1] = v * z;
    point_mm[3 * i + 2] = z;
    sigma_mm[i] = measured ? sigma_depth_mm[i] * std::sqrt(u * u + v * v + 1.0F) : 0.0F;
    points += measured ? 1 : 0;
  }
  return points;
}

}  // namespace beltpick::range
