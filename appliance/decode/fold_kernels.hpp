// What folding does to one row of pixels, for cameras of 8 and of 16 bits. Internal to decode.
#pragma once

#include <cstdint>

#include "decode/plan.hpp"

namespace beltpick::decode {

// Adds a phase frame to the sums of its fringe (or sets them when `first`).
//   8 bits: sum += round((level << 7) * weight_q15 / 2^15), rounded term by term; 16 bits: sum += level * weight.
void accumulate_row(const std::uint8_t* levels, int count, const Accumulate& work, std::int16_t* cosine,
                    std::int16_t* sine);
void accumulate_row(const std::uint16_t* levels, int count, const Accumulate& work, float* cosine, float* sine);

void accumulate_mean_row(const std::uint8_t* levels, int count, bool first, std::uint16_t* mean);
void accumulate_mean_row(const std::uint16_t* levels, int count, bool first, float* mean);

// flags |= bit where the level has reached full_scale.
void flag_saturation_row(const std::uint8_t* levels, int count, int full_scale, std::uint8_t bit, bool first,
                         std::uint8_t* flags);
void flag_saturation_row(const std::uint16_t* levels, int count, int full_scale, std::uint8_t bit, bool first,
                         std::uint8_t* flags);

void widen_extremes_row(const std::uint8_t* levels, int count, bool first, std::uint8_t* white, std::uint8_t* black);
void widen_extremes_row(const std::uint16_t* levels, int count, bool first, std::uint16_t* white, std::uint16_t* black);

// How one Gray frame is turned into bits.
struct BitRule {
  std::uint16_t mask = 1;      // of this bit
  bool inverted = false;       // bright means 0; twins come upright first instead
  bool first = false;          // sets code and weak instead of adding to them
  float to_level8 = 1.0F;      // 255 / full_scale
  float scale = 1.0F;          // of the threshold
  float noise_factor = 1.0F;   // variance of (level - threshold) over that of one grey level
  float weak_fraction = 0.0F;  // see GrayCode
};

// code |= mask where the level lies above the threshold; weak |= mask where it lies nearer to it than four standard
// deviations of the camera's noise, or than weak_fraction of half the contrast (of the
// threshold itself where no black tells the contrast).
// Threshold: midway to the inverted twin; midway between white and black, times scale; mean times scale.
void resolve_twin_row(const std::uint8_t* upright, const std::uint8_t* inverted, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak);
void resolve_twin_row(const std::uint16_t* upright, const std::uint16_t* inverted, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak);
void resolve_midpoint_row(const std::uint8_t* levels, const std::uint8_t* white, const std::uint8_t* black, int count,
                          const BitRule& rule, std::uint16_t* code, std::uint16_t* weak);
void resolve_midpoint_row(const std::uint16_t* levels, const std::uint16_t* white, const std::uint16_t* black,
                          int count, const BitRule& rule, std::uint16_t* code, std::uint16_t* weak);
void resolve_mean_row(const std::uint8_t* levels, const std::uint16_t* mean, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak);
void resolve_mean_row(const std::uint16_t* levels, const float* mean, int count, const BitRule& rule,
                      std::uint16_t* code, std::uint16_t* weak);

}  // namespace beltpick::decode
