#include "decode/bit_kernels.hpp"

#include <algorithm>
#include <limits>

#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

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

// `middle(i)` gives the level that parts bright from dark, contrast(i) how far (at most) both lie from it.
template <class Pixel, class MiddleOf, class ContrastOf>
BELTPICK_INLINE void make_threshold(int count, const ThresholdRule& rule, Pixel* __restrict level,
                                    Pixel* __restrict reach, MiddleOf middle, ContrastOf contrast) {
  const float most = static_cast<float>(std::numeric_limits<Pixel>::max());
  const Reach reach_of(rule, most);
  const float near = rule.weak_fraction;
  for (int i = 0; i < count; ++i) {
    const float m = middle(i);
    level[i] = static_cast<Pixel>(static_cast<int>(std::min(m, most)));
    reach[i] = static_cast<Pixel>(reach_of.at(m, near * contrast(i)));
  }
}

template <class Pixel>
BELTPICK_INLINE void midpoint_threshold(const Pixel* __restrict white, const Pixel* __restrict black, int count,
                                        const ThresholdRule& rule, Pixel* __restrict level, Pixel* __restrict reach) {
  const float half = 0.5F * rule.scale;
  make_threshold(
      count, rule, level, reach,
      [=](int i) { return half * (static_cast<float>(white[i]) + static_cast<float>(black[i])); },
      [=](int i) { return half * (static_cast<float>(white[i]) - static_cast<float>(black[i])); });
}

// The same in whole numbers, where noise alone makes bits weak.
BELTPICK_INLINE void stepped_threshold(const std::uint8_t* __restrict white, const std::uint8_t* __restrict black,
                                       int count, const MidpointReaches& reaches, std::uint8_t* __restrict level,
                                       std::uint8_t* __restrict reach) {
  const auto above = reaches.above;
  const std::uint16_t always = reaches.always;
  for (int i = 0; i < count; ++i) {
    const auto sum = static_cast<std::uint16_t>(white[i] + black[i]);
    std::uint16_t steps = always;
#pragma GCC unroll 8
    for (std::size_t k = 0; k < MidpointReaches::kSteps; ++k) {
      steps = static_cast<std::uint16_t>(steps + (sum > above[k] ? 1 : 0));
    }
    level[i] = static_cast<std::uint8_t>(sum >> 1);
    reach[i] = static_cast<std::uint8_t>(steps);
  }
}

template <class Pixel, class Sum>
BELTPICK_INLINE void mean_threshold(const Sum* __restrict mean, int count, const ThresholdRule& rule,
                                    Pixel* __restrict level, Pixel* __restrict reach) {
  const float scale = rule.scale;
  const auto middle = [=](int i) { return scale * static_cast<float>(mean[i]); };
  make_threshold(count, rule, level, reach, middle, middle);
}

struct Verdict {
  std::uint8_t bright, weak;  // 1 or 0
};

// Packs the verdicts of a row's pixels.
template <class VerdictOf>
BELTPICK_INLINE void pack(int count, std::uint8_t* __restrict bits, VerdictOf verdict) {
  const int width = (count + 7) / 8;
  std::uint8_t* __restrict bright_row = bits;
  std::uint8_t* __restrict weak_row = bits + width;
  const int whole = std::max(0, count - 7 * width);  // bytes all of whose pixels there are
#pragma GCC ivdep
  for (int j = 0; j < whole; ++j) {
    std::uint8_t bright = 0;
    std::uint8_t weak = 0;
#pragma GCC unroll 8
    for (int s = 0; s < 8; ++s) {
      const Verdict v = verdict(s * width + j);
      bright = static_cast<std::uint8_t>(bright | v.bright << s);
      weak = static_cast<std::uint8_t>(weak | v.weak << s);
    }
    bright_row[j] = bright;
    weak_row[j] = weak;
  }
  for (int j = whole; j < width; ++j) {
    unsigned bright = 0;
    unsigned weak = 0;
    for (int s = 0; s < 8 && s * width + j < count; ++s) {
      const Verdict v = verdict(s * width + j);
      bright |= static_cast<unsigned>(v.bright) << s;
      weak |= static_cast<unsigned>(v.weak) << s;
    }
    bright_row[j] = static_cast<std::uint8_t>(bright);
    weak_row[j] = static_cast<std::uint8_t>(weak);
  }
}

template <class Pixel>
BELTPICK_INLINE void resolve_levels(const Pixel* __restrict levels, const Pixel* __restrict threshold,
                                    const Pixel* __restrict reach, int count, bool inverted,
                                    std::uint8_t* __restrict bits) {
  const std::uint8_t flip = inverted ? 1 : 0;
  pack(count, bits, [=](int i) {
    const Pixel level = levels[i];
    const Pixel middle = threshold[i];
    const std::uint8_t bright = level > middle ? 1 : 0;
    const auto apart = static_cast<Pixel>(std::max(level, middle) - std::min(level, middle));
    const auto steps = static_cast<Pixel>(apart - bright);  // whole levels between the two sides of the threshold
    return Verdict{static_cast<std::uint8_t>(bright ^ flip), static_cast<std::uint8_t>(steps < reach[i] ? 1 : 0)};
  });
}

template <class Pixel>
BELTPICK_INLINE void resolve_twin(const Pixel* __restrict upright, const Pixel* __restrict inverted, int count,
                                  const ThresholdRule& rule, std::uint8_t* __restrict bits) {
  // The margin is half the difference: its square against the noise, or against the share of the threshold.
  const float noise = 4.0F * kWeakSigmas * kWeakSigmas * rule.noise_factor / (rule.to_level8 * rule.to_level8);
  const float floor = noise * kCameraNoise.floor_variance;
  const float shot = 0.5F * noise * kCameraNoise.shot_variance_per_level * rule.to_level8;
  const float near = rule.weak_fraction;
  pack(count, bits, [=](int i) {
    const auto up = static_cast<float>(upright[i]);
    const auto down = static_cast<float>(inverted[i]);
    const float difference = up - down;
    const float within = near * (up + down);
    const float weak_squared = std::max(floor + shot * (up + down), within * within);
    return Verdict{static_cast<std::uint8_t>(upright[i] > inverted[i] ? 1 : 0),
                   static_cast<std::uint8_t>(difference * difference < weak_squared ? 1 : 0)};
  });
}

// The same in 8-bit numbers.
BELTPICK_INLINE void resolve_near_twins(const std::uint8_t* __restrict upright, const std::uint8_t* __restrict inverted,
                                        int count, const TwinMargins& margins, std::uint8_t* __restrict bits) {
  const std::uint8_t always = margins.always;
  const auto above = margins.above;
  pack(count, bits, [=](int i) {
    const std::uint8_t up = upright[i];
    const std::uint8_t down = inverted[i];
    const auto apart = static_cast<std::uint8_t>(std::max(up, down) - std::min(up, down));
    const auto middle = static_cast<std::uint8_t>((up + down + 1) >> 1);
    // How many of `above` the middle exceeds, by halving them.
    const bool beyond_4 = middle > above[3];
    const std::uint8_t next_2 = beyond_4 ? above[5] : above[1];
    const bool beyond_2 = middle > next_2;
    const std::uint8_t lower_1 = beyond_2 ? above[2] : above[0];
    const std::uint8_t upper_1 = beyond_2 ? above[6] : above[4];
    const std::uint8_t next_1 = beyond_4 ? upper_1 : lower_1;
    const auto near = static_cast<std::uint8_t>(always + (beyond_4 ? 4 : 0) + (beyond_2 ? 2 : 0) +
                                                (middle > next_1 ? 1 : 0) + (middle > above[7] ? 1 : 0));
    return Verdict{static_cast<std::uint8_t>(up > down ? 1 : 0), static_cast<std::uint8_t>(apart < near ? 1 : 0)};
  });
}

}  // namespace

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
void midpoint_threshold_row(const std::uint8_t* white, const std::uint8_t* black, int count, const ThresholdRule& rule,
                            std::uint8_t* level, std::uint8_t* reach) {
  const MidpointReaches* reaches = rule.midpoint_reaches;
  if (rule.scale == 1.0F && rule.weak_fraction == 0.0F && reaches != nullptr && reaches->known) {
    stepped_threshold(white, black, count, *reaches, level, reach);
  } else {
    midpoint_threshold(white, black, count, rule, level, reach);
  }
}
BELTPICK_KERNEL
void midpoint_threshold_row(const std::uint16_t* white, const std::uint16_t* black, int count,
                            const ThresholdRule& rule, std::uint16_t* level, std::uint16_t* reach) {
  midpoint_threshold(white, black, count, rule, level, reach);
}
BELTPICK_KERNEL
void mean_threshold_row(const std::uint16_t* mean, int count, const ThresholdRule& rule, std::uint8_t* level,
                        std::uint8_t* reach) {
  mean_threshold(mean, count, rule, level, reach);
}
BELTPICK_KERNEL
void mean_threshold_row(const float* mean, int count, const ThresholdRule& rule, std::uint16_t* level,
                        std::uint16_t* reach) {
  mean_threshold(mean, count, rule, level, reach);
}

BELTPICK_KERNEL
void resolve_levels_row(const std::uint8_t* levels, const std::uint8_t* level, const std::uint8_t* reach, int count,
                        bool inverted, std::uint8_t* bits) {
  resolve_levels(levels, level, reach, count, inverted, bits);
}
BELTPICK_KERNEL
void resolve_levels_row(const std::uint16_t* levels, const std::uint16_t* level, const std::uint16_t* reach, int count,
                        bool inverted, std::uint8_t* bits) {
  resolve_levels(levels, level, reach, count, inverted, bits);
}
BELTPICK_KERNEL
void resolve_twin_row(const std::uint8_t* upright, const std::uint8_t* inverted, int count, const ThresholdRule& rule,
                      std::uint8_t* bits) {
  if (rule.weak_fraction == 0.0F && rule.twin_margins != nullptr && rule.twin_margins->known) {
    resolve_near_twins(upright, inverted, count, *rule.twin_margins, bits);
  } else {
    resolve_twin(upright, inverted, count, rule, bits);
  }
}
BELTPICK_KERNEL
void resolve_twin_row(const std::uint16_t* upright, const std::uint16_t* inverted, int count, const ThresholdRule& rule,
                      std::uint8_t* bits) {
  resolve_twin(upright, inverted, count, rule, bits);
}

}  // namespace beltpick::decode
