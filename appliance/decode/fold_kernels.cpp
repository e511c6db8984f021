#include "decode/fold_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

// Bits closer to their threshold than this many standard deviations are weak: of bits just beyond, one in 700 is wrong.
constexpr float kWeakSigmas = 3.0F;

#define BELTPICK_INLINE [[gnu::always_inline]] inline

// The rounded product of vector units, in the form in which the compiler knows it: both factors 16-bit and in memory.
BELTPICK_INLINE std::int16_t scaled_term(std::int16_t level_q7, std::int16_t weight_q15) {
  return static_cast<std::int16_t>((((level_q7 * weight_q15) >> 14) + 1) >> 1);
}

constexpr int kBlock = 64;
using Block = std::int16_t[kBlock];

// A block of pixels of 8 bits; the weights stand once for each pixel.
template <int kCount, bool kFirst>
BELTPICK_INLINE void accumulate_block(const std::array<const std::uint8_t*, kMaxTogether>& levels, int first, int count,
                                      const Block (&wc)[kMaxTogether], const Block (&ws)[kMaxTogether],
                                      std::int16_t* __restrict cosine, std::int16_t* __restrict sine) {
  alignas(64) Block level_q7[kCount];
  for (std::size_t n = 0; n < kCount; ++n) {
    const std::uint8_t* from = levels[n] + first;
    for (int i = 0; i < count; ++i) level_q7[n][i] = static_cast<std::int16_t>(from[i] << 7);
  }
  for (int i = 0; i < count; ++i) {
    std::int16_t c = kFirst ? std::int16_t{0} : cosine[first + i];
    std::int16_t s = kFirst ? std::int16_t{0} : sine[first + i];
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kCount; ++n) {
      c = static_cast<std::int16_t>(c + scaled_term(level_q7[n][i], wc[n][i]));
      s = static_cast<std::int16_t>(s + scaled_term(level_q7[n][i], ws[n][i]));
    }
    cosine[first + i] = c;
    sine[first + i] = s;
  }
}

template <int kCount, bool kFirst>
BELTPICK_INLINE void accumulate(const FringeRows<std::uint8_t>& rows, int count, std::int16_t* __restrict cosine,
                                std::int16_t* __restrict sine) {
  alignas(64) Block wc[kMaxTogether];
  alignas(64) Block ws[kMaxTogether];
  for (std::size_t n = 0; n < kCount; ++n) {
    for (int i = 0; i < kBlock; ++i) {
      wc[n][i] = rows.cosine_weight_q15[n];
      ws[n][i] = rows.sine_weight_q15[n];
    }
  }
  int first = 0;
  for (; first + kBlock <= count; first += kBlock) {
    accumulate_block<kCount, kFirst>(rows.levels, first, kBlock, wc, ws, cosine, sine);
  }
  accumulate_block<kCount, kFirst>(rows.levels, first, count - first, wc, ws, cosine, sine);
}

// Without fused operations and frame by frame, so that all vector units and all groupings round alike.
template <int kCount, bool kFirst>
BELTPICK_INLINE void accumulate(const FringeRows<std::uint16_t>& rows, int count, float* __restrict cosine,
                                float* __restrict sine) {
  const auto wc = rows.cosine_weight;
  const auto ws = rows.sine_weight;
  const auto levels = rows.levels;
  for (int i = 0; i < count; ++i) {
    float c = kFirst ? 0.0F : cosine[i];
    float s = kFirst ? 0.0F : sine[i];
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kCount; ++n) {
      const auto level = static_cast<float>(levels[n][i]);
      c += wc[n] * level;
      s += ws[n] * level;
    }
    cosine[i] = c;
    sine[i] = s;
  }
}

template <int kCount, class Pixel, class Mean>
BELTPICK_INLINE void accumulate_mean(const FringeRows<Pixel>& rows, int count, Mean* __restrict mean) {
  const auto levels = rows.levels;
  if (rows.first) {
    for (int i = 0; i < count; ++i) mean[i] = static_cast<Mean>(levels[0][i]);
  } else {
    for (int i = 0; i < count; ++i) mean[i] = static_cast<Mean>(mean[i] + levels[0][i]);
  }
  if constexpr (kCount > 1) {
    for (int i = 0; i < count; ++i) {
      Mean m = mean[i];
#pragma GCC unroll 4
      for (std::size_t n = 1; n < kCount; ++n) m = static_cast<Mean>(m + levels[n][i]);
      mean[i] = m;
    }
  }
}

template <int kCount, class Pixel>
BELTPICK_INLINE void flag_saturation(const FringeRows<Pixel>& rows, int count, std::uint8_t* __restrict flags) {
  const auto limit = static_cast<Pixel>(std::min<int>(rows.full_scale, std::numeric_limits<Pixel>::max()));
  const auto levels = rows.levels;
  const std::uint8_t bit = rows.saturation_bit;
  const std::uint8_t keep = rows.first_flags ? 0 : 0xFF;
  for (int i = 0; i < count; ++i) {
    Pixel most = levels[0][i];
#pragma GCC unroll 4
    for (std::size_t n = 1; n < kCount; ++n) most = std::max(most, levels[n][i]);
    flags[i] = static_cast<std::uint8_t>((flags[i] & keep) | (most >= limit ? bit : 0));
  }
}

template <int kCount, class Pixel, class Sum, class Mean>
BELTPICK_INLINE void fold_together(const FringeRows<Pixel>& rows, int count, Sum* cosine, Sum* sine, Mean* mean,
                                   std::uint8_t* flags) {
  if (rows.first) {
    accumulate<kCount, true>(rows, count, cosine, sine);
  } else {
    accumulate<kCount, false>(rows, count, cosine, sine);
  }
  if (mean != nullptr) accumulate_mean<kCount>(rows, count, mean);
  flag_saturation<kCount>(rows, count, flags);
}

template <class Pixel, class Sum, class Mean>
BELTPICK_INLINE void fold_fringe(const FringeRows<Pixel>& rows, int count, Sum* cosine, Sum* sine, Mean* mean,
                                 std::uint8_t* flags) {
  static_assert(kMaxTogether == 4);
  switch (rows.count) {
    case 1:
      fold_together<1>(rows, count, cosine, sine, mean, flags);
      return;
    case 2:
      fold_together<2>(rows, count, cosine, sine, mean, flags);
      return;
    case 3:
      fold_together<3>(rows, count, cosine, sine, mean, flags);
      return;
    default:
      fold_together<4>(rows, count, cosine, sine, mean, flags);
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

// How far a bit's level may lie from its threshold, in whole levels, for noise to turn it.
struct Reach {
  Reach(const ThresholdRule& rule, float most_level)
      : floor(noise(rule) * kCameraNoise.floor_variance),
        shot(noise(rule) * kCameraNoise.shot_variance_per_level * rule.to_level8),
        most(most_level) {}
  // At a threshold of `level`, where levels nearer than `within` are weak anyway.
  BELTPICK_INLINE int at(float level, float within) const {
    const float weak = std::sqrt(std::max(floor + shot * level, within * within));
    return static_cast<int>(std::min(std::max(weak + 0.5F, 1.0F), most));
  }
  static float noise(const ThresholdRule& rule) {
    return kWeakSigmas * kWeakSigmas * rule.noise_factor / (rule.to_level8 * rule.to_level8);
  }
  float floor, shot, most;
};

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

TwinMargins twin_margins(float to_level8) {
  constexpr float kSquareOne = 128.0F;  // a level squared, in whole numbers
  const float noise = kSquareOne * 4.0F * kWeakSigmas * kWeakSigmas * kTwinNoiseFactor / (to_level8 * to_level8);
  const auto floor = static_cast<int>(noise * kCameraNoise.floor_variance + 0.5F);
  const auto shot = static_cast<int>(0.5F * noise * kCameraNoise.shot_variance_per_level * to_level8 + 0.5F);
  TwinMargins margins;
  margins.above.fill(0xFF);
  if (shot == 0) return margins;
  std::size_t steps = 0;
  for (int apart = 0; apart < 256; ++apart) {
    const int beyond_floor = apart * apart * static_cast<int>(kSquareOne) - floor;
    const int least_sum = beyond_floor < 0 ? 0 : beyond_floor / shot + 1;
    const int least_middle = (least_sum + apart % 2 + 1) / 2;  // a sum is odd where the difference is
    if (least_middle > 255) break;
    if (least_sum == 0) {
      ++margins.always;
    } else if (steps < TwinMargins::kSteps) {
      margins.above[steps++] = static_cast<std::uint8_t>(least_middle - 1);
    } else {
      return margins;
    }
  }
  margins.known = true;
  return margins;
}

MidpointReaches midpoint_reaches(float to_level8) {
  constexpr int kMostSum = 2 * 255;
  const Reach reach_of({.to_level8 = to_level8, .noise_factor = kMidpointNoiseFactor}, 255.0F);
  MidpointReaches reaches;
  reaches.above.fill(0xFFFF);
  int reach = reach_of.at(0.0F, 0.0F);
  reaches.always = static_cast<std::uint8_t>(reach);
  std::size_t steps = 0;
  for (int sum = 1; sum <= kMostSum; ++sum) {
    for (const int here = reach_of.at(0.5F * static_cast<float>(sum), 0.0F); reach < here; ++reach) {
      if (steps == MidpointReaches::kSteps) return reaches;
      reaches.above[steps++] = static_cast<std::uint16_t>(sum - 1);
    }
  }
  reaches.known = true;
  return reaches;
}

BELTPICK_KERNEL
void accumulate_row(const FringeRows<std::uint8_t>& rows, int count, std::int16_t* cosine, std::int16_t* sine,
                    std::uint16_t* mean, std::uint8_t* flags) {
  fold_fringe(rows, count, cosine, sine, mean, flags);
}
BELTPICK_KERNEL
void accumulate_row(const FringeRows<std::uint16_t>& rows, int count, float* cosine, float* sine, float* mean,
                    std::uint8_t* flags) {
  fold_fringe(rows, count, cosine, sine, mean, flags);
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
