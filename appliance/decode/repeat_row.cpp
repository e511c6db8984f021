#include "decode/repeat_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

constexpr float kMovedSigmas = 6.0F;    // one pixel in 500 million by noise
constexpr float kFlickerShare = 0.03F;  // of the level

template <class Pixel>
constexpr int kMiddle = (std::numeric_limits<Pixel>::max() + 1) / 2;

template <class Pixel>
[[gnu::always_inline]] inline void subtract_first(const Pixel* last, int count, Pixel* first) {
  constexpr int kTop = std::numeric_limits<Pixel>::max();
  for (int i = 0; i < count; ++i) {
    const int difference = kMiddle<Pixel> + static_cast<int>(last[i]) - static_cast<int>(first[i]);
    first[i] = static_cast<Pixel>(std::min(std::max(difference, 0), kTop));
  }
}

template <class Pixel>
void mark_moved(const Pixel* difference, const std::uint8_t* texture, int count, float to_level8, PixelState* state,
                float* first_px, float* second_px) {
  constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < count; ++i) {
    const auto level8 = static_cast<float>(texture[i]);
    const float off8 = to_level8 * std::fabs(static_cast<float>(static_cast<int>(difference[i]) - kMiddle<Pixel>));
    const float noise8 = std::sqrt(2.0F * kCameraNoise.variance(level8));
    if (state[i] != PixelState::kValid || off8 <= kMovedSigmas * noise8 + kFlickerShare * level8) continue;
    state[i] = PixelState::kMoved;
    if (first_px != nullptr) first_px[i] = kNotMeasured;
    if (second_px != nullptr) second_px[i] = kNotMeasured;
  }
}

}  // namespace

BELTPICK_KERNEL
void subtract_first_row(const std::uint8_t* last, int count, std::uint8_t* first) {
  subtract_first(last, count, first);
}
BELTPICK_KERNEL
void subtract_first_row(const std::uint16_t* last, int count, std::uint16_t* first) {
  subtract_first(last, count, first);
}

void mark_moved_row(const std::uint8_t* difference, const std::uint8_t* texture, int count, float to_level8,
                    PixelState* state, float* first_px, float* second_px) {
  mark_moved(difference, texture, count, to_level8, state, first_px, second_px);
}
void mark_moved_row(const std::uint16_t* difference, const std::uint8_t* texture, int count, float to_level8,
                    PixelState* state, float* first_px, float* second_px) {
  mark_moved(difference, texture, count, to_level8, state, first_px, second_px);
}

}  // namespace beltpick::decode
