#include "decode/finish_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"
#include "decode/gray_cells.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

template <class Pixel>
BELTPICK_INLINE void levels_between(const Pixel* white, const Pixel* black, int count, float scale, float* mean8,
                                    float* half8) {
  const float half = 0.5F * scale;
  for (int i = 0; i < count; ++i) {
    mean8[i] = (static_cast<float>(white[i]) + static_cast<float>(black[i])) * half;
    half8[i] = (static_cast<float>(white[i]) - static_cast<float>(black[i])) * half;
  }
}

template <class Sum>
BELTPICK_INLINE void levels_of_mean(const Sum* mean, int count, float scale, float* mean8, float* half8) {
  for (int i = 0; i < count; ++i) mean8[i] = half8[i] = static_cast<float>(mean[i]) * scale;
}

BELTPICK_INLINE std::uint8_t level_byte(float level8) {
  return static_cast<std::uint8_t>(static_cast<int>(std::min(level8, 255.0F) + 0.5F));
}

template <class Pixel>
BELTPICK_INLINE void texture_of(const Pixel* white, int count, float scale, std::uint8_t* texture) {
  if constexpr (sizeof(Pixel) == 1) {
    if (scale == 1.0F) {
      std::copy_n(white, count, texture);
      return;
    }
  }
  for (int i = 0; i < count; ++i) texture[i] = level_byte(static_cast<float>(white[i]) * scale);
}

// Phase noise may put a pixel at the projector's edge this far outside.
constexpr float kOutsidePx = 1.0F;
constexpr float kBorderSigmas = 5.0F;
constexpr float kFullLevel8 = 254.0F;

// 1 where no bit is weak but those at the borders of the cell. Arithmetic: single bits as truth values keep the
// compiler from vector units.
BELTPICK_INLINE std::uint8_t unless_far(std::uint8_t weak) {
  static_assert(kWeakFar == 1);
  return static_cast<std::uint8_t>(~weak & kWeakFar);
}

}  // namespace

BELTPICK_KERNEL
void levels_row(const std::uint8_t* white, const std::uint8_t* black, int count, float scale, float* mean8,
                float* half8) {
  levels_between(white, black, count, scale, mean8, half8);
}
BELTPICK_KERNEL
void levels_row(const std::uint16_t* white, const std::uint16_t* black, int count, float scale, float* mean8,
                float* half8) {
  levels_between(white, black, count, scale, mean8, half8);
}
BELTPICK_KERNEL
void levels_row(const std::uint16_t* mean, int count, float scale, float* mean8, float* half8) {
  levels_of_mean(mean, count, scale, mean8, half8);
}
BELTPICK_KERNEL
void levels_row(const float* mean, int count, float scale, float* mean8, float* half8) {
  levels_of_mean(mean, count, scale, mean8, half8);
}

BELTPICK_KERNEL
void texture_row(const std::uint8_t* white, int count, float scale, std::uint8_t* texture) {
  texture_of(white, count, scale, texture);
}
BELTPICK_KERNEL
void texture_row(const std::uint16_t* white, int count, float scale, std::uint8_t* texture) {
  texture_of(white, count, scale, texture);
}
BELTPICK_KERNEL
void texture_row(const float* mean8, const float* amplitude8, int count, std::uint8_t* texture) {
  for (int i = 0; i < count; ++i) texture[i] = level_byte(mean8[i] + amplitude8[i]);
}

BELTPICK_KERNEL
void gray_only_row(const std::uint16_t* __restrict cell, const std::uint8_t* __restrict weak, int count,
                   const CellRule& rule, float* __restrict x_px, std::uint8_t* __restrict order_safe) {
  const float cell_px = rule.cell_px;
  const float end_px = rule.extent_px - 0.5F;
  const int cells = rule.cells;
  for (int i = 0; i < count; ++i) {
    const float left_px = static_cast<float>(cell[i]) * cell_px - 0.5F;
    x_px[i] = 0.5F * (left_px + std::min(left_px + cell_px, end_px));
    order_safe[i] = cell[i] < cells ? unless_far(weak[i]) : std::uint8_t{0};
  }
}

BELTPICK_KERNEL
void gray_phase_row(const float* __restrict turn, const std::uint16_t* __restrict cell,
                    const std::uint8_t* __restrict weak, int count, const CellRule& rule, float* __restrict x_px,
                    std::uint8_t* __restrict order_safe) {
  const float cell_px = rule.cell_px;
  const float period_px = rule.period_px;
  const float per_period = 1.0F / period_px;
  const float guard_px = rule.guard_px;
  const float first_px = -0.5F;
  const float last_px = std::nextafter(rule.extent_px - 0.5F, 0.0F);
  const int cells = rule.cells;
  for (int i = 0; i < count; ++i) {
    const float centre_px = (static_cast<float>(cell[i]) + 0.5F) * cell_px - 0.5F;
    const float wrapped_px = turn[i] * period_px;
    // Orders are -1 or more: adding 2 makes the cut a floor.
    const int order = static_cast<int>((centre_px - wrapped_px) * per_period + 2.5F) - 2;
    const float x = wrapped_px + static_cast<float>(order) * period_px;
    const float inside_px = std::min(std::max(x, first_px), last_px);
    const bool safe =
        (cell[i] < cells) & (std::fabs(x - centre_px) <= guard_px) & (std::fabs(x - inside_px) <= kOutsidePx);
    x_px[i] = inside_px;
    order_safe[i] = safe ? unless_far(weak[i]) : std::uint8_t{0};
  }
}

BELTPICK_KERNEL
void settle_borders_row(const std::uint16_t* __restrict cell, const std::uint8_t* __restrict weak,
                        const float* __restrict amplitude8, const float* __restrict mean8, int count,
                        const CellRule& rule, float noise_px, float* __restrict x_px,
                        std::uint8_t* __restrict order_safe) {
  const float end_px = rule.extent_px - 0.5F;
  const float period_px = rule.period_px;
  for (int i = 0; i < count; ++i) {
    const bool left = (weak[i] & kWeakLeft) != 0;
    const bool right = (weak[i] & kWeakRight) != 0;
    const float offset_px = x_px[i] - ((static_cast<float>(cell[i]) + 0.5F) * rule.cell_px - 0.5F);
    const bool at_left = left & !right;
    const bool at_right = right & !left;
    const bool beyond_left = at_left & (offset_px > 0.25F * period_px);
    const bool beyond_right = at_right & (offset_px < -0.25F * period_px);
    const float moved_px = x_px[i] + (beyond_left ? -period_px : 0.0F) + (beyond_right ? period_px : 0.0F);
    const float sigma_level = std::sqrt(kCameraNoise.floor_variance + kCameraNoise.shot_variance_per_level * mean8[i]);
    const float reach_px = kBorderSigmas * noise_px * sigma_level / std::max(amplitude8[i], 1e-3F);
    const bool near_border = std::fabs(offset_px) > 0.5F * rule.cell_px - reach_px;
    const bool outside = (moved_px < -0.5F) | (moved_px >= end_px);
    x_px[i] = outside ? x_px[i] : moved_px;
    order_safe[i] =
        static_cast<std::uint8_t>(order_safe[i] & ((at_left | at_right) | !near_border ? 1 : 0) & (outside ? 0 : 1));
  }
}

BELTPICK_KERNEL
void state_row(const float* __restrict amplitude8, const float* __restrict mean8, const float* __restrict half8,
               const std::uint8_t* __restrict order_safe, const std::uint8_t* __restrict saturated, int count,
               const StateRule& rule, PixelState* __restrict state, float* __restrict x_px) {
  constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();
  // Bytes throughout: the compiler would widen numbers between.
  constexpr auto kValid = static_cast<std::uint8_t>(PixelState::kValid);
  constexpr auto kOrderUncertain = static_cast<std::uint8_t>(PixelState::kOrderUncertain);
  constexpr auto kSaturated = static_cast<std::uint8_t>(PixelState::kSaturated);
  constexpr auto kLowModulation = static_cast<std::uint8_t>(PixelState::kLowModulation);
  constexpr auto kDark = static_cast<std::uint8_t>(PixelState::kDark);
  const float factor = rule.least_sigmas * rule.noise_gain * (rule.least_sigmas * rule.noise_gain);
  const std::uint8_t* __restrict flags = saturated == nullptr ? order_safe : saturated;
  const std::uint8_t bit = saturated == nullptr ? std::uint8_t{0} : rule.saturation_bit;
  for (int i = 0; i < count; ++i) {
    const float least = factor * (kCameraNoise.floor_variance + kCameraNoise.shot_variance_per_level * mean8[i]);
    const float light8 = half8[i] * rule.bright_share;
    const bool bright = (light8 > 0.0F) & (light8 * light8 >= least);
    const bool modulated = (amplitude8[i] > 0.0F) & (amplitude8[i] * amplitude8[i] >= least);
    const std::uint8_t dim = bright ? kLowModulation : kDark;
    const std::uint8_t weak = mean8[i] >= kFullLevel8 ? kSaturated : dim;
    const bool direct = amplitude8[i] >= rule.least_contrast * half8[i];
    const std::uint8_t order = (order_safe[i] != 0) & direct ? kValid : kOrderUncertain;
    const std::uint8_t measured = modulated ? order : weak;
    const std::uint8_t told = (flags[i] & bit) != 0 ? kSaturated : measured;
    x_px[i] = told == kValid ? x_px[i] : kNotMeasured;
    state[i] = static_cast<PixelState>(told);
  }
}

BELTPICK_KERNEL
void gray_axis_row(const std::uint16_t* __restrict cell, const std::uint8_t* __restrict weak,
                   const float* __restrict mean8, const float* __restrict half8, int count, const CellRule& rule,
                   const StateRule& light, float* __restrict x_px, float* __restrict amplitude8,
                   PixelState* __restrict state) {
  constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();
  constexpr auto kValid = static_cast<std::uint8_t>(PixelState::kValid);
  constexpr auto kUncertain = static_cast<std::uint8_t>(PixelState::kOrderUncertain);
  constexpr auto kDark = static_cast<std::int32_t>(PixelState::kDark);
  constexpr auto kSaturated = static_cast<std::int32_t>(PixelState::kSaturated);
  const float factor = light.least_sigmas * light.noise_gain * (light.least_sigmas * light.noise_gain);
  const float cell_px = rule.cell_px;
  const float end_px = rule.extent_px - 0.5F;
  const auto last = static_cast<std::uint16_t>(std::min(rule.cells - 1, 0xFFFF));
  for (int i = 0; i < count; ++i) {
    const float least = factor * (kCameraNoise.floor_variance + kCameraNoise.shot_variance_per_level * mean8[i]);
    const float bright8 = std::max(half8[i], 0.0F);
    const std::int32_t unlit = mean8[i] >= kFullLevel8 ? kSaturated : kDark;
    state[i] = static_cast<PixelState>(bright8 * bright8 >= least ? std::int32_t{kValid} : unlit);
    amplitude8[i] = half8[i];
  }
  for (int i = 0; i < count; ++i) {
    const std::uint8_t safe = cell[i] <= last ? unless_far(weak[i]) : std::uint8_t{0};
    const auto light_state = static_cast<std::uint8_t>(state[i]);
    const std::uint8_t order = safe != 0 ? kValid : kUncertain;
    state[i] = static_cast<PixelState>(light_state == kValid ? order : light_state);
  }
  for (int i = 0; i < count; ++i) {
    const float left_px = static_cast<float>(cell[i]) * cell_px - 0.5F;
    const float centre_px = 0.5F * (left_px + std::min(left_px + cell_px, end_px));
    x_px[i] = state[i] == PixelState::kValid ? centre_px : kNotMeasured;
  }
}

BELTPICK_KERNEL
void join_axes_row(const float* __restrict second_amplitude8, const PixelState* __restrict second_state, int count,
                   float* __restrict modulation, PixelState* __restrict state) {
  for (int i = 0; i < count; ++i) {
    const bool valid = second_state[i] == PixelState::kValid;
    const bool other_valid = state[i] == PixelState::kValid;
    const float worse = std::min(modulation[i], second_amplitude8[i]);
    modulation[i] = valid & other_valid ? worse : other_valid ? modulation[i] : second_amplitude8[i];
    state[i] = valid ? PixelState::kValid : state[i];
  }
}

}  // namespace beltpick::decode
