// Bits of 8-bit frames against the noise, for every pair of levels.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/camera_noise.hpp"
#include "decode/bit_kernels.hpp"

namespace beltpick::decode {
namespace {

constexpr int kLevels = 256;

// The bit rows of one upright level with all inverted ones.
std::vector<std::uint8_t> resolved(int up, const ThresholdRule& rule) {
  std::vector<std::uint8_t> upright(kLevels, static_cast<std::uint8_t>(up));
  std::vector<std::uint8_t> inverted(kLevels);
  for (std::size_t i = 0; i < kLevels; ++i) inverted[i] = static_cast<std::uint8_t>(i);
  std::vector<std::uint8_t> bits(bit_row_bytes(kLevels));
  resolve_twin_row(upright.data(), inverted.data(), kLevels, rule, bits.data());
  return bits;
}

bool bit_of(const std::vector<std::uint8_t>& bits, int pixel, bool weak) {
  constexpr int kWidth = kLevels / 8;
  return (bits[static_cast<std::size_t>(pixel % kWidth + (weak ? kWidth : 0))] >> (pixel / kWidth) & 1) != 0;
}

TEST_CASE("twins are weak where their half difference is within three standard deviations of its noise") {
  for (const float to_level8 : {1.0F, 255.0F / 200.0F}) {
    const TwinMargins margins = twin_margins(to_level8);
    REQUIRE(margins.known);
    REQUIRE(std::is_sorted(margins.above.begin(), margins.above.end()));
    const ThresholdRule rule{.to_level8 = to_level8, .noise_factor = kTwinNoiseFactor, .twin_margins = &margins};
    int at_the_margin = 0;
    for (int up = 0; up < kLevels; ++up) {
      const auto bits = resolved(up, rule);
      for (int down = 0; down < kLevels; ++down) {
        const double level8 = 0.5 * (up + down) * static_cast<double>(to_level8);
        const double sigma8 = std::sqrt(0.5 * static_cast<double>(kCameraNoise.variance(static_cast<float>(level8))));
        const double sigmas = 0.5 * std::abs(up - down) * static_cast<double>(to_level8) / sigma8;
        INFO(up << " and " << down << ", " << sigmas << " standard deviations");
        REQUIRE(bit_of(bits, down, false) == (up > down));
        if (std::abs(sigmas - 3.0) < 0.03) {
          ++at_the_margin;
          continue;
        }
        REQUIRE(bit_of(bits, down, true) == (sigmas < 3.0));
      }
    }
    CHECK(at_the_margin < 400);
  }
}

TEST_CASE("twins are as weak without margins worked out as with them, but for rounding") {
  const TwinMargins margins = twin_margins(1.0F);
  ThresholdRule rule{.noise_factor = kTwinNoiseFactor};
  int differ = 0;
  for (int up = 0; up < kLevels; ++up) {
    rule.twin_margins = nullptr;
    const auto plain = resolved(up, rule);
    rule.twin_margins = &margins;
    const auto bits = resolved(up, rule);
    for (int down = 0; down < kLevels; ++down) {
      REQUIRE(bit_of(plain, down, false) == bit_of(bits, down, false));
      differ += bit_of(plain, down, true) != bit_of(bits, down, true) ? 1 : 0;
    }
  }
  CHECK(differ < 60);
}

TEST_CASE("thresholds midway between white and black are the same worked out ahead") {
  for (const float to_level8 : {1.0F, 255.0F / 200.0F}) {
    const MidpointReaches reaches = midpoint_reaches(to_level8);
    REQUIRE(reaches.known);
    ThresholdRule rule{.to_level8 = to_level8, .noise_factor = kMidpointNoiseFactor};
    std::vector<std::uint8_t> blacks(kLevels);
    for (std::size_t i = 0; i < kLevels; ++i) blacks[i] = static_cast<std::uint8_t>(i);
    for (int white = 0; white < kLevels; ++white) {
      const std::vector<std::uint8_t> whites(kLevels, static_cast<std::uint8_t>(white));
      std::array<std::vector<std::uint8_t>, 2> level, reach;
      for (const std::size_t ahead : {0, 1}) {
        rule.midpoint_reaches = ahead == 1 ? &reaches : nullptr;
        level[ahead].resize(kLevels);
        reach[ahead].resize(kLevels);
        midpoint_threshold_row(whites.data(), blacks.data(), kLevels, rule, level[ahead].data(), reach[ahead].data());
      }
      INFO("white " << white);
      REQUIRE(level[0] == level[1]);
      REQUIRE(reach[0] == reach[1]);
    }
  }
}

}  // namespace
}  // namespace beltpick::decode
