#include "decode/bit_margins.hpp"

namespace beltpick::decode {

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

}  // namespace beltpick::decode
