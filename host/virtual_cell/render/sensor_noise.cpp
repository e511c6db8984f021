#include "virtual_cell/render/sensor_noise.hpp"

#include <algorithm>
#include <cmath>

#include "base/kernel.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr std::uint32_t kTableSize = 1U << 18U;
constexpr float kReadVariance = static_cast<float>(kReadNoiseElectrons * kReadNoiseElectrons);
constexpr float kFullWell = static_cast<float>(kFullWellElectrons);
constexpr float kLevelPerElectron = 255.0F / kFullWell;

BELTPICK_KERNEL void expose_row(const float* signal, const float* normal, int count, std::uint8_t* out) {
  for (int i = 0; i < count; ++i) {
    const float electrons = std::min(signal[i], 2.0F) * kFullWell;
    const float noisy = electrons + std::sqrt(electrons + kReadVariance) * normal[i];
    const float level = std::min(std::max(noisy * kLevelPerElectron + 0.5F, 0.0F), 255.0F);
    out[i] = static_cast<std::uint8_t>(static_cast<int>(level));
  }
}

}  // namespace

SensorNoise::SensorNoise() {
  // Box and Muller's method: exact, and the same on every machine.
  Random random(2026, 7);
  normal_.reserve(kTableSize);
  while (normal_.size() < kTableSize) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
    const double angle = 2.0 * kPi * random.uniform();
    normal_.push_back(static_cast<float>(radius * std::cos(angle)));
    normal_.push_back(static_cast<float>(radius * std::sin(angle)));
  }
}

void SensorNoise::expose(std::span<const float> signal, std::uint64_t seed, ImageView<std::uint8_t> image) const {
  Random random(seed, 11);
  for (int row = 0; row < image.rows; ++row) {
    const std::uint32_t start = random.below(kTableSize - static_cast<std::uint32_t>(image.cols));
    expose_row(signal.data() + static_cast<std::size_t>(row) * image.cols, normal_.data() + start, image.cols,
               image.row(row));
  }
}

void SensorNoise::expose_noise_free(std::span<const float> signal, ImageView<std::uint8_t> image) {
  for (int row = 0; row < image.rows; ++row) {
    const float* from = signal.data() + static_cast<std::size_t>(row) * image.cols;
    for (int col = 0; col < image.cols; ++col) {
      image(row, col) = static_cast<std::uint8_t>(std::clamp(std::lround(from[col] * 255.0F), 0L, 255L));
    }
  }
}

}  // namespace beltpick::virtual_cell
