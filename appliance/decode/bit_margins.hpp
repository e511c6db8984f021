// How near to its threshold a Gray bit is weak: camera noise, worked out once for all pixels. Internal to decode.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/camera_noise.hpp"

namespace beltpick::decode {

// Bits closer to their threshold than this many standard deviations are weak: of bits just beyond, one in 700 is wrong.
inline constexpr float kWeakSigmas = 3.0F;

// Where the bit of 8-bit twins is weak by noise alone: their difference is less than `always`, or exceeds it by no more
// than the number of the levels `above` that their mean, rounded up, lies above.
struct TwinMargins {
  static constexpr std::size_t kSteps = 8;
  bool known = false;  // false: noise needs more steps
  std::uint8_t always = 0;
  std::array<std::uint8_t, kSteps> above{};  // ascending; 255: never
};
inline constexpr float kTwinNoiseFactor = 0.5F;  // half the difference of two frames
TwinMargins twin_margins(float to_level8);

// How far 8-bit levels reach from a threshold midway between white and black: `always`, and one more for each of the
// sums of white and black `above` that theirs exceeds.
struct MidpointReaches {
  static constexpr std::size_t kSteps = 8;
  bool known = false;  // false: noise needs more steps
  std::uint8_t always = 0;
  std::array<std::uint16_t, kSteps> above{};  // ascending; 0xFFFF: never
};
inline constexpr float kMidpointNoiseFactor = 1.5F;  // one frame against the mean of two
MidpointReaches midpoint_reaches(float to_level8);

// How the level that parts bright from dark is found.
struct ThresholdRule {
  float to_level8 = 1.0F;                             // 255 / full_scale
  float scale = 1.0F;                                 // of the threshold
  float noise_factor = 1.0F;                          // variance of (level - threshold) over that of one grey level
  float weak_fraction = 0.0F;                         // see GrayCode
  const TwinMargins* twin_margins = nullptr;          // the same worked out for twins; may be null
  const MidpointReaches* midpoint_reaches = nullptr;  // and for a threshold midway; may be null
};

// How far a bit's level may lie from its threshold, in whole levels, for noise to turn it.
struct Reach {
  Reach(const ThresholdRule& rule, float most_level)
      : floor(noise(rule) * kCameraNoise.floor_variance),
        shot(noise(rule) * kCameraNoise.shot_variance_per_level * rule.to_level8),
        most(most_level) {}
  // At a threshold of `level`, where levels nearer than `within` are weak anyway.
  [[gnu::always_inline]] int at(float level, float within) const {
    const float weak = std::sqrt(std::max(floor + shot * level, within * within));
    return static_cast<int>(std::min(std::max(weak + 0.5F, 1.0F), most));
  }
  static float noise(const ThresholdRule& rule) {
    return kWeakSigmas * kWeakSigmas * rule.noise_factor / (rule.to_level8 * rule.to_level8);
  }
  float floor, shot, most;
};

}  // namespace beltpick::decode
