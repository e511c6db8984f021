#include "range/lens_strength.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::range {
namespace {

constexpr std::size_t kRays = 256;
constexpr int kCodes = 48;
constexpr float kNearPx = 0.004F;  // what floats resolve of a depth

struct Sample {
  std::array<float, kRays> u{}, v{}, code_px{}, modulation{};
  std::array<std::uint8_t, kRays> texture{};
};

struct Depths {
  std::array<float, kRays> mm{}, per_px{};
};

// With a noise of one pixel and no other, the standard deviation is what a pixel of code is worth in mm.
Depths depths_of(const AxisModel& model, const Sample& sample) {
  Depths depths;
  depth_row(model,
            {sample.u.data(), sample.v.data(), sample.code_px.data(), sample.modulation.data(), sample.texture.data(),
             CodeNoise{.floor_px = 1.0F, .slope_px = 0.0F}},
            static_cast<int>(kRays), depths.mm.data(), depths.per_px.data());
  return depths;
}

}  // namespace

bool one_step_suffices(AxisModel model, int extent_px, std::span<const float> ray_u, std::span<const float> ray_v) {
  Sample sample;
  for (std::size_t i = 0; i < kRays; ++i) {
    const std::size_t at = i * (ray_u.size() - 1) / (kRays - 1);
    sample.u[i] = ray_u[at];
    sample.v[i] = ray_v[at];
  }
  for (int c = 0; c < kCodes; ++c) {
    sample.code_px.fill(static_cast<float>(c) * static_cast<float>(extent_px - 1) / (kCodes - 1));
    model.strong_lens = true;
    const Depths four = depths_of(model, sample);
    model.strong_lens = false;
    const Depths one = depths_of(model, sample);
    for (std::size_t i = 0; i < kRays; ++i) {
      if (four.mm[i] == 0.0F) continue;
      if (!(std::fabs(one.mm[i] - four.mm[i]) <= kNearPx * four.per_px[i])) return false;
    }
  }
  return true;
}

}  // namespace beltpick::range
