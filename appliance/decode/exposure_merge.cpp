#include "decode/exposure_merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/camera_noise.hpp"

namespace beltpick::decode {
namespace {

constexpr float kAgreeSigmas = 6.0F;

float weight_of(const ExposedRow& exposed, int i) {
  const float amplitude = exposed.axis.amplitude8[i];
  return amplitude * amplitude / kCameraNoise.variance(exposed.mean8[i]);
}

}  // namespace

void merge_exposure_row(const ExposedRow& exposed, int count, bool first, const MergedRow& merged) {
  const AxisPixels& current = exposed.axis;
  const AxisPixels& best = merged.axis;
  for (int i = 0; i < count; ++i) {
    if (first) {
      merged.weight[i] = weight_of(exposed, i);
      continue;
    }
    const bool valid = current.state[i] == PixelState::kValid;
    const bool best_valid = best.state[i] == PixelState::kValid;
    const float weight = weight_of(exposed, i);
    if (!valid) {
      const bool tells_more = current.state[i] != PixelState::kSaturated || best.state[i] == PixelState::kSaturated;
      if (!best_valid && tells_more) {
        best.state[i] = current.state[i];
        best.amplitude8[i] = current.amplitude8[i];
        merged.weight[i] = weight;
      }
      continue;
    }
    if (!best_valid) {
      best.x_px[i] = current.x_px[i];
      best.state[i] = PixelState::kValid;
      merged.weight[i] = weight;
      continue;
    }
    const float off_px = current.x_px[i] - best.x_px[i];
    const float noise_px = exposed.noise_px * std::sqrt(1.0F / weight + 1.0F / merged.weight[i]);
    if (std::fabs(off_px) > kAgreeSigmas * noise_px + exposed.slack_px) {
      best.state[i] = PixelState::kOrderUncertain;
      best.x_px[i] = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    best.x_px[i] += off_px * weight / (weight + merged.weight[i]);
    merged.weight[i] += weight;
  }
}

void finish_merge_row(const MergedRow& merged, const std::uint8_t* texture, int count) {
  for (int i = 0; i < count; ++i) {
    const float variance = kCameraNoise.variance(0.5F * static_cast<float>(texture[i]));
    merged.axis.amplitude8[i] = std::sqrt(merged.weight[i] * variance);
  }
}

}  // namespace beltpick::decode
