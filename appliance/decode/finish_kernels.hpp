// What finishing does to one row of pixels: Gray bits and phases to
// coordinates, light to states.
// Internal to decode. "level8": grey levels scaled to 0..255.
#pragma once

#include <cstdint>

#include "base/stages.hpp"

namespace beltpick::decode {

// mean8 = (white + black) / 2 * scale, half8 = (white - black) / 2 * scale.
void levels_row(const std::uint8_t* white, const std::uint8_t* black, int count, float scale, float* mean8,
                float* half8);
void levels_row(const std::uint16_t* white, const std::uint16_t* black, int count, float scale, float* mean8,
                float* half8);
// mean8 = half8 = mean * scale: what is known without a white and a black frame.
void levels_row(const std::uint16_t* mean, int count, float scale, float* mean8, float* half8);
void levels_row(const float* mean, int count, float scale, float* mean8, float* half8);

void texture_row(const std::uint8_t* white, int count, float scale, std::uint8_t* texture);
void texture_row(const std::uint16_t* white, int count, float scale, std::uint8_t* texture);
// texture = mean8 + amplitude8.
void texture_row(const float* mean8, const float* amplitude8, int count, std::uint8_t* texture);

struct CellRule {
  float cell_px = 1.0F;
  int cells = 0;
  float extent_px = 0.0F;
  float period_px = 0.0F;  // of the fringe; unused without one
  float guard_px = 0.0F;   // further from the cell's centre than this, Gray code and phase contradict each other
};

// `cell` and `weak` below are those of cells_row().

// Centre of the Gray cell, cut at the extent. order_safe = 0 where a weak bit might mean another than the next cell,
// or the cell lies beyond the extent.
void gray_only_row(const std::uint16_t* cell, const std::uint8_t* weak, int count, const CellRule& rule, float* x_px,
                   std::uint8_t* order_safe);

// The fringe order is the one that puts the phase nearest to the cell's centre; x in [-0.5, extent - 0.5).
// order_safe = 0 as above, and where the phase contradicts the cell.
void gray_phase_row(const float* turn, const std::uint16_t* cell, const std::uint8_t* weak, int count,
                    const CellRule& rule, float* x_px, std::uint8_t* order_safe);

// For cells about as wide as the period, whose two borders look alike to the phase: at a border the weak bit says which
// of the two it is, and the phase on which side of it; without a single weak bit, order_safe = 0 within five standard
// deviations of the phase noise (noise_px = its sigma times amplitude over the noise of one grey level).
void settle_borders_row(const std::uint16_t* cell, const std::uint8_t* weak, const float* amplitude8,
                        const float* mean8, int count, const CellRule& rule, float noise_px, float* x_px,
                        std::uint8_t* order_safe);

// Amplitudes below `least_sigmas` of their noise are not measured; the noise is noise_gain times that of one grey
// level. kDark where even a fringe of `bright_share` of half8 would not be measured; kSaturated where white and black
// are.
struct StateRule {
  float least_sigmas = 1.0F;
  float noise_gain = 1.0F;
  std::uint8_t saturation_bit = 0;
  float bright_share = 1.0F;
  float least_contrast = 0.0F;  // amplitude over half8; below it broad Gray stripes may be another surface's light
};
// kSaturated where `saturated` has the rule's bit; `saturated` may be null. x_px = NaN where the state is not valid.
void state_row(const float* amplitude8, const float* mean8, const float* half8, const std::uint8_t* order_safe,
               const std::uint8_t* saturated, int count, const StateRule& rule, PixelState* state, float* x_px);

// One axis of a row: what an exposure or an axis measured.
struct AxisPixels {
  float *x_px, *amplitude8;
  PixelState* state;
};
// Gray code alone, in one go: what gray_only_row() gives, with the half contrast for amplitude and judged by
// state_row() (sigmas and gain of the rule alone).
void gray_axis_row(const std::uint16_t* cell, const std::uint8_t* weak, const float* mean8, const float* half8,
                   int count, const CellRule& rule, const StateRule& light, float* x_px, float* amplitude8,
                   PixelState* state);
// A second axis beside the first: a pixel is valid where either is, and as well modulated as the worse valid one.
void join_axes_row(const float* second_amplitude8, const PixelState* second_state, int count, float* modulation,
                   PixelState* state);

}  // namespace beltpick::decode
