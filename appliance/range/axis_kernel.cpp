#include "range/axis_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"

namespace beltpick::range {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

AxisModel::Form form_of(const Vec3& f) {
  return {static_cast<float>(f.x()), static_cast<float>(f.y()), static_cast<float>(f.z())};
}

BELTPICK_INLINE float at(const AxisModel::Form& form, float u, float v) { return form[0] * u + form[1] * v + form[2]; }

// Where a pixel's line stands in the projector: o = offset + slope s.
struct Line {
  float offset, slope;
};

// What the lens does at (s, o): how far the image of s lies from the code seen, and how fast that changes along the
// line.
struct Bend {
  float radial, r2, miss, gradient;
};

BELTPICK_INLINE float radial_of(const AxisModel& m, float r2) { return 1.0F + r2 * (m.k1 + r2 * (m.k2 + r2 * m.k3)); }

BELTPICK_INLINE Bend bend_at(const AxisModel& m, const Line& line, float s, float o, float seen) {
  const float ss = s * s;
  const float r2 = ss + o * o;
  const float radial = radial_of(m, r2);
  const float bend2 = 2.0F * m.k1 + r2 * (4.0F * m.k2 + r2 * (6.0F * m.k3));  // 2 d radial / d r^2
  const float so = s * o;
  const float tangential_so2 = 2.0F * m.tangential_so;
  const float tangential_ss2 = 2.0F * m.tangential_ss;
  const float along_s = radial + ss * bend2 + tangential_so2 * o + 3.0F * tangential_ss2 * s;
  const float along_o = so * bend2 + tangential_so2 * s + tangential_ss2 * o;
  const float miss = s * radial + tangential_so2 * so + m.tangential_ss * (r2 + 2.0F * ss) - seen;
  return {radial, r2, miss, along_s + line.slope * along_o};
}

// One step of the fixed-point iteration: most of the shift by the lens at `s` taken off. What it leaves, a pixel or two
// of a usual lens, Newton's step that follows brings below what floats resolve; lens_strength.hpp makes sure.
BELTPICK_INLINE float corrected_start(const AxisModel& m, const Line& line, float s) {
  const float o = line.offset + line.slope * s;
  const float ss = s * s;
  const float r2 = ss + o * o;
  return s - s * r2 * (m.k1 + r2 * m.k2);
}

// kStrong: three steps of Newton's method before the last one, from the code itself; else none, from a corrected start.
template <bool kStrong, bool kBoth>
BELTPICK_INLINE void depths(const AxisModel& model, const AxisInput& input, int count, float* __restrict depth_mm,
                            float* __restrict sigma_mm, float* __restrict other_px, float* __restrict sigma_px) {
  const AxisModel m = model;
  const float* __restrict ray_u = input.ray_u;
  const float* __restrict ray_v = input.ray_v;
  const float* __restrict code_px = input.code_px;
  const float* __restrict modulation = input.modulation;
  const std::uint8_t* __restrict texture = input.texture;
  constexpr float kFarthestMm = 1e6F;
  const float per_focal = 1.0F / m.focal_s;
  const float first_px = -0.5F - kModelSlackPx;
  const float last_px = m.other_extent_px - 0.5F + kModelSlackPx;
  const float floor_squared = input.noise.floor_px * input.noise.floor_px;
  const float slope_squared = input.noise.slope_px * input.noise.slope_px;
  for (int i = 0; i < count; ++i) {
    const float u = ray_u[i];
    const float v = ray_v[i];
    const float across = at(m.across, u, v);
    const float amplitude = std::max(modulation[i], 1e-3F);
    const float amplitude_squared = amplitude * amplitude;
    const float per_both = 1.0F / (across * amplitude_squared);  // two quotients for one division
    const float per_across = per_both * amplitude_squared;
    const Line line{at(m.offset, u, v) * per_across, at(m.slope, u, v) * per_across};
    const float seen = (code_px[i] - m.centre_s) * per_focal;
    float s = seen;
    if constexpr (kStrong) {
#pragma GCC unroll 3  // before vectorisation, which takes no inner loops
      for (int step = 0; step < 3; ++step) {
        const Bend bend = bend_at(m, line, s, line.offset + line.slope * s, seen);
        s -= bend.miss / bend.gradient;
      }
    } else {
      s = corrected_start(m, line, seen);
    }
    float o = line.offset + line.slope * s;
    const Bend bend = bend_at(m, line, s, o, seen);
    // The last step, s - miss / gradient, and the depth there in one division.
    const float g = bend.gradient;
    const float sg = s * g - bend.miss;
    const float per_denominator = 1.0F / (sg * at(m.ray_z, u, v) - g * at(m.ray_s, u, v));
    const float z = (m.translation_s * g - sg * m.translation_z) * per_denominator;
    const float mm_per_px = std::fabs(across * g * (per_denominator * per_denominator) * per_focal);
    float other = o * bend.radial * m.focal_o + m.centre_o;  // within a pixel or two, which the slack has room for
    if constexpr (kStrong || kBoth) {
      // 1 / gradient is about 2 - gradient; what that leaves moves the other coordinate by hundredths of a pixel.
      s -= bend.miss * (2.0F - g);
      o = line.offset + line.slope * s;
      other =
          (o * bend.radial + 2.0F * m.tangential_ss * s * o + m.tangential_so * (bend.r2 + 2.0F * o * o)) * m.focal_o +
          m.centre_o;
    }
    const bool good = (g > 0.0F) & (z > 0.0F) & (z < kFarthestMm) & (z * at(m.ray_z, u, v) + m.translation_z > 0.0F) &
                      (other > first_px) & (other < last_px);
    // The texture is what white light shows; a fringe's mean is half of it.
    const float level_variance =
        kCameraNoise.floor_variance + (0.5F * kCameraNoise.shot_variance_per_level) * static_cast<float>(texture[i]);
    const float variance_px = floor_squared + slope_squared * level_variance * (per_both * across);
    depth_mm[i] = good ? z : 0.0F;
    sigma_mm[i] = std::sqrt(variance_px * (u * u + v * v + 1.0F)) * mm_per_px;
    if constexpr (kBoth) {
      other_px[i] = other;
      sigma_px[i] = std::sqrt(variance_px);
    }
  }
}

}  // namespace

AxisModel axis_model(const Calibration& calibration, Axis axis) {
  const bool column = axis == Axis::kColumn;
  const int s = column ? 0 : 1;
  const Lens& lens = calibration.projector;
  const auto& pose = calibration.T_projector_camera;
  const Vec3 q_s = pose.rotation.row(s);
  const Vec3 q_o = pose.rotation.row(1 - s);
  const Vec3 q_z = pose.rotation.row(2);
  const double t_s = pose.translation_mm[s];
  const double t_o = pose.translation_mm[1 - s];
  const double t_z = pose.translation_mm[2];
  AxisModel model;
  model.ray_s = form_of(q_s);
  model.ray_z = form_of(q_z);
  model.across = form_of(t_z * q_s - t_s * q_z);
  model.slope = form_of(t_z * q_o - t_o * q_z);
  model.offset = form_of(t_o * q_s - t_s * q_o);
  model.translation_s = static_cast<float>(t_s);
  model.translation_z = static_cast<float>(t_z);
  model.focal_s = static_cast<float>(column ? lens.fx_px : lens.fy_px);
  model.centre_s = static_cast<float>(column ? lens.cx_px : lens.cy_px);
  model.focal_o = static_cast<float>(column ? lens.fy_px : lens.fx_px);
  model.centre_o = static_cast<float>(column ? lens.cy_px : lens.cx_px);
  model.other_extent_px = static_cast<float>(column ? lens.height : lens.width);
  model.k1 = static_cast<float>(lens.distortion[0]);
  model.k2 = static_cast<float>(lens.distortion[1]);
  model.k3 = static_cast<float>(lens.distortion[4]);
  model.tangential_so = static_cast<float>(lens.distortion[column ? 2 : 3]);
  model.tangential_ss = static_cast<float>(lens.distortion[column ? 3 : 2]);
  return model;
}

BELTPICK_KERNEL
void depth_row(const AxisModel& model, const AxisInput& in, int count, float* depth_mm, float* sigma_mm) {
  if (model.strong_lens) {
    depths<true, false>(model, in, count, depth_mm, sigma_mm, nullptr, nullptr);
  } else {
    depths<false, false>(model, in, count, depth_mm, sigma_mm, nullptr, nullptr);
  }
}

BELTPICK_KERNEL
void depth_row(const AxisModel& model, const AxisInput& in, int count, float* depth_mm, float* sigma_mm,
               float* other_px, float* sigma_px) {
  if (model.strong_lens) {
    depths<true, true>(model, in, count, depth_mm, sigma_mm, other_px, sigma_px);
  } else {
    depths<false, true>(model, in, count, depth_mm, sigma_mm, other_px, sigma_px);
  }
}

}  // namespace beltpick::range
