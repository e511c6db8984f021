// What folding does to one row of pixels of Gray frames and of those that give their thresholds, for cameras of 8 and
// of 16 bits. Internal to decode.
#pragma once

#include <cstddef>
#include <cstdint>

#include "decode/bit_margins.hpp"

namespace beltpick::decode {

// The brightest and the darkest level so far; `first`: of this frame alone.
void widen_extremes_row(const std::uint8_t* levels, int count, bool first, std::uint8_t* white, std::uint8_t* black);
void widen_extremes_row(const std::uint16_t* levels, int count, bool first, std::uint16_t* white, std::uint16_t* black);

// A Gray frame's threshold in whole levels: bright is above `level`; a bit is weak where a threshold moved by `reach`
// levels would turn it: nearer than three standard deviations of the camera's noise, or than weak_fraction of half the
// contrast (of the threshold itself where no black tells the contrast). At least one level.
//   midway between white and black, times scale; or mean times scale
void midpoint_threshold_row(const std::uint8_t* white, const std::uint8_t* black, int count, const ThresholdRule& rule,
                            std::uint8_t* level, std::uint8_t* reach);
void midpoint_threshold_row(const std::uint16_t* white, const std::uint16_t* black, int count,
                            const ThresholdRule& rule, std::uint16_t* level, std::uint16_t* reach);
void mean_threshold_row(const std::uint16_t* mean, int count, const ThresholdRule& rule, std::uint8_t* level,
                        std::uint8_t* reach);
void mean_threshold_row(const float* mean, int count, const ThresholdRule& rule, std::uint16_t* level,
                        std::uint16_t* reach);

// A row of one Gray bit: bit_row_bytes(count) bytes, the first half for the bits, the second for where they are weak.
// Bit s of byte j is that of pixel s * W + j, W the bytes of a half: pixels that vector units take together lie beside
// each other, and packing needs no shuffling.
constexpr std::size_t bit_row_bytes(int count) { return 2 * ((static_cast<std::size_t>(count) + 7) / 8); }

// Bit 1 where the level lies above the threshold, or below it where `inverted`.
void resolve_levels_row(const std::uint8_t* levels, const std::uint8_t* level, const std::uint8_t* reach, int count,
                        bool inverted, std::uint8_t* bits);
void resolve_levels_row(const std::uint16_t* levels, const std::uint16_t* level, const std::uint16_t* reach, int count,
                        bool inverted, std::uint8_t* bits);
// Bit 1 where the upright frame is brighter than its inverted twin; weak as above, the threshold midway between both.
void resolve_twin_row(const std::uint8_t* upright, const std::uint8_t* inverted, int count, const ThresholdRule& rule,
                      std::uint8_t* bits);
void resolve_twin_row(const std::uint16_t* upright, const std::uint16_t* inverted, int count, const ThresholdRule& rule,
                      std::uint8_t* bits);

}  // namespace beltpick::decode
