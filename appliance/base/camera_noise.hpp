// The noise of a camera's grey levels, scaled to 8 bits: what decoding calls too weak and what range calls its sigma
// both follow from it, so that no threshold is tuned to a scene.
#pragma once

namespace beltpick {

// variance = floor + shot * level. Shot noise of a 10,000 e- full well at 255 levels (a common 1/2" to 1/1.8" sensor),
// and a floor of read noise and 8-bit rounding.
struct CameraNoise {
  float floor_variance = 0.64F;
  float shot_variance_per_level = 255.0F / 10000.0F;

  // `level8`: a grey level scaled to 0..255. Returns levels squared.
  [[nodiscard]] float variance(float level8) const { return floor_variance + shot_variance_per_level * level8; }
};

inline constexpr CameraNoise kCameraNoise{};

}  // namespace beltpick
