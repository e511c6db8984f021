#include "decode/fold_kernels.hpp"

#include <algorithm>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

// Bits closer to their threshold than this many standard deviations are weak: of bits just beyond, one in 700 is wrong.
constexpr float kWeakSigmas = 3.0F;

#define BELTPICK_INLINE [[gnu::always_inline]] inline

// Without fused operations and in this order, so that all vector units round alike.
BELTPICK_INLINE std::int16_t scaled_term(std::uint8_t level, std::int16_t weight_q15) {
  return static_cast<std::int16_t>(((level << 7) * weight_q15 + 0x4000) >> 15);
}

template <class Pixel, class Sum>
BELTPICK_INLINE void accumulate_mean(const Pixel* levels, int count, bool first, Sum* mean) {
  if (first) {
    for (int i = 0; i < count; ++i) mean[i] = static_cast<Sum>(levels[i]);
  } else {
    for (int i = 0; i < count; ++i) mean[i] = static_cast<Sum>(mean[i] + levels[i]);
  }
}

template <class Pixel>
BELTPICK_INLINE void flag_saturation(const Pixel* levels, int count, Pixel limit, std::uint8_t bit, bool first,
                                     std::uint8_t* flags) {
  if (first) {
    for (int i = 0; i < count; ++i) flags[i] = levels[i] >= limit ? bit : std::uint8_t{0};
  } else {
    for (int i = 0; i < count; ++i) {
      flags[i] = static_cast<std::uint8_t>(flags[i] | (levels[i] >= limit ? bit : std::uint8_t{0}));
    }
  }
}

template <class Pixel>
BELTPICK_INLINE void widen_extremes(const Pixel* levels, int count, bool first, Pixel* white, Pixel* black) {
  if (first) {
    for (int i = 0; i < count; ++i) white[i] = black[i] = levels[i];
  } else {
    for (int i = 0; i < count; ++i) {
      white[i] = std::max(white[i], levels[i]);
      black[i] = std::min(black[i], levels[i]);
    }
  }
}

// `threshold(i)` gives the level that parts bright from dark, contrast(i) how far (at most) both lie from it.
template <class Pixel, class ThresholdOf, class ContrastOf>
BELTPICK_INLINE void resolve(const Pixel* levels, int count, const BitRule& rule, std::uint16_t* code,
                             std::uint16_t* weak, ThresholdOf threshold, ContrastOf contrast) {
  const float noise = kWeakSigmas * kWeakSigmas * rule.noise_factor;
  const float floor = noise * kCameraNoise.floor_variance;
  const float shot = noise * kCameraNoise.shot_variance_per_level;
  const float to_level8 = rule.to_level8;
  const float near = rule.weak_fraction * rule.to_level8;
  const unsigned flip = rule.inverted ? rule.mask : 0U;
  const auto mask = rule.mask;
  const auto keep = static_cast<std::uint16_t>(rule.first ? 0U : 0xFFFFU);
  for (int i = 0; i < count; ++i) {
    const float middle = threshold(i) * to_level8;
    const float margin = static_cast<float>(levels[i]) * to_level8 - middle;
    const float within = near * contrast(i);
    const float weak_squared = std::max(floor + shot * middle, within * within);
    const unsigned bright = margin > 0.0F ? mask : 0U;
    const unsigned is_weak = margin * margin < weak_squared ? mask : 0U;
    code[i] = static_cast<std::uint16_t>((code[i] & keep) | (bright ^ flip));
    weak[i] = static_cast<std::uint16_t>((weak[i] & keep) | is_weak);
  }
}

template <class Pixel>
BELTPICK_INLINE void resolve_twin(const Pixel* levels, const Pixel* twin, int count, const BitRule& rule,
                                  std::uint16_t* code, std::uint16_t* weak) {
  const auto middle = [=](int i) { return 0.5F * (static_cast<float>(levels[i]) + static_cast<float>(twin[i])); };
  resolve(levels, count, rule, code, weak, middle, middle);
}

template <class Pixel>
BELTPICK_INLINE void resolve_midpoint(const Pixel* levels, const Pixel* white, const Pixel* black, int count,
                                      const BitRule& rule, std::uint16_t* code, std::uint16_t* weak) {
  const float half = 0.5F * rule.scale;
  resolve(
      levels, count, rule, code, weak,
      [=](int i) { return half * (static_cast<float>(white[i]) + static_cast<float>(black[i])); },
      [=](int i) { return half * (static_cast<float>(white[i]) - static_cast<float>(black[i])); });
}

template <class Pixel, class Sum>
BELTPICK_INLINE void resolve_mean(const Pixel* levels, const Sum* mean, int count, const BitRule& rule,
                                  std::uint16_t* code, std::uint16_t* weak) {
  const float scale = rule.scale;
  const auto middle = [=](int i) { return scale * static_cast<float>(mean[i]); };
  resolve(levels, count, rule, code, weak, middle, middle);
}

}  // namespace

BELTPICK_KERNEL
void accumulate_row(const std::uint8_t* levels, int count, const Accumulate& work, std::int16_t* cosine,
                    std::int16_t* sine) {
  const std::int16_t wc = work.cosine_weight_q15;
  const std::int16_t ws = work.sine_weight_q15;
  if (work.first) {
    for (int i = 0; i < count; ++i) {
      cosine[i] = scaled_term(levels[i], wc);
      sine[i] = scaled_term(levels[i], ws);
    }
  } else {
    for (int i = 0; i < count; ++i) {
      cosine[i] = static_cast<std::int16_t>(cosine[i] + scaled_term(levels[i], wc));
      sine[i] = static_cast<std::int16_t>(sine[i] + scaled_term(levels[i], ws));
    }
  }
}

BELTPICK_KERNEL
void accumulate_row(const std::uint16_t* levels, int count, const Accumulate& work, float* cosine, float* sine) {
  const float wc = work.cosine_weight;
  const float ws = work.sine_weight;
  if (work.first) {
    for (int i = 0; i < count; ++i) {
      cosine[i] = wc * static_cast<float>(levels[i]);
      sine[i] = ws * static_cast<float>(levels[i]);
    }
  } else {
    for (int i = 0; i < count; ++i) {
      cosine[i] += wc * static_cast<float>(levels[i]);
      sine[i] += ws * static_cast<float>(levels[i]);
    }
  }
}

BELTPICK_KERNEL
void accumulate_mean_row(const std::uint8_t* levels, int count, bool first, std::uint16_t* mean) {
  accumulate_mean(levels, count, first, mean);
}
BELTPICK_KERNEL
void accumulate_mean_row(const std::uint16_t* levels, int count, bool first, float* mean) {
  accumulate_mean(levels, count, first, mean);
}

BELTPICK_KERNEL
void flag_saturation_row(const std::uint8_t* levels, int count, int full_scale, std::uint8_t bit, bool first,
                         std::uint8_t* flags) {
  flag_saturation(levels, count, static_cast<std::uint8_t>(std::min(full_scale, 255)), bit, first, flags);
}
BELTPICK_KERNEL
void flag_saturation_row(const std::uint16_t* levels, int count, int full_scale, std::uint8_t bit, bool first,
                         std::uint8_t* flags) {
  flag_saturation(levels, count, static_cast<std::uint16_t>(std::min(full_scale, 65535)), bit, first, flags);
}

BELTPICK_KERNEL
void widen_extremes_row(const std::uint8_t* levels, int count, bool first, std::uint8_t* white, std::uint8_t* black) {
  widen_extremes(levels, count, first, white, black);
}
BELTPICK_KERNEL
void widen_extremes_row(const std::uint16_t* levels, int count, bool first, std::uint16_t* white,
                        std::uint16_t* black) {
  widen_extremes(levels, count, first, white, black);
}

BELTPICK_KERNEL
void resolve_twin_row(const std::uint8_t* levels, const std::uint8_t* twin, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak) {
  resolve_twin(levels, twin, count, rule, code, weak);
}
BELTPICK_KERNEL
void resolve_twin_row(const std::uint16_t* levels, const std::uint16_t* twin, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak) {
  resolve_twin(levels, twin, count, rule, code, weak);
}
BELTPICK_KERNEL
void resolve_midpoint_row(const std::uint8_t* levels, const std::uint8_t* white, const std::uint8_t* black, int count,
                          const BitRule& rule, std::uint16_t* code, std::uint16_t* weak) {
  resolve_midpoint(levels, white, black, count, rule, code, weak);
}
BELTPICK_KERNEL
void resolve_midpoint_row(const std::uint16_t* levels, const std::uint16_t* white, const std::uint16_t* black,
                          int count, const BitRule& rule, std::uint16_t* code, std::uint16_t* weak) {
  resolve_midpoint(levels, white, black, count, rule, code, weak);
}
BELTPICK_KERNEL
void resolve_mean_row(const std::uint8_t* levels, const std::uint16_t* mean, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak) {
  resolve_mean(levels, mean, count, rule, code, weak);
}
BELTPICK_KERNEL
void resolve_mean_row(const std::uint16_t* levels, const float* mean, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak) {
  resolve_mean(levels, mean, count, rule, code, weak);
}

}  // namespace beltpick::decode
