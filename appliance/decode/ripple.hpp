// Ripple: what a projector's gamma, or any other curve between pattern and image, does to the phase of few steps, found
// from the capture itself and taken away. Internal to decode.
//
// N equal shifts let the harmonics N k +- 1 of the fringe into its first one: the measured phase p is off by a sum of
// sin(m N p), m = 1, 2, .. Over many pixels the true phase is spread evenly within the period, so the density of the
// measured one tells how the two hang together (histogram equalisation): with c_m the mean of cos(m N p),
//   true = p + sum of 2 c_m / (m N) sin(m N p).
// The mean of sin(m N p) is 0 for every such curve: its scatter between the tiles of the image tells how far c_m can be
// trusted. Defocus, which changes over the image, weakens harmonics: c_m is a smooth function of the place.
#pragma once

#include <array>
#include <cstdint>

#include "decode/row_decoder.hpp"

namespace beltpick::decode {

// Sums over the image's tiles of one channel, in fixed memory.
class RippleMeter {
 public:
  RippleMeter(int steps, double offset_rad, int rows, int cols);

  // Rows are taken every row_step() rows: enough to know, and cheap.
  [[nodiscard]] int row_step() const { return row_step_; }
  // Phases and amplitudes of a row. Blocks of pixels with a saturated or a weak one are left out whole: a choice by
  // pixel would favour some phases.
  void add_row(int row, const float* turn, const float* amplitude8, const std::uint8_t* flags,
               std::uint8_t saturation_bits);
  // Ripple::orders is 0 where nothing significant was found, or too few pixels.
  [[nodiscard]] Ripple fit() const;

 private:
  static constexpr int kTileRows = 12, kTileCols = 16;
  struct Tile {
    double count = 0.0;
    std::array<double, kRippleOrders> cosine{}, sine{};
  };

  [[nodiscard]] bool fit_order(int order, std::array<float, kRippleTerms>& amplitude_turns, float& limit_turns) const;

  int steps_, rows_, cols_, row_step_;
  double offset_rad_;
  std::array<Tile, kTileRows * kTileCols> tiles_{};
};

// Measures the ripple of a channel of the capture in `context`; none where its steps keep harmonics out,
// or where the view holds too few of its periods.
template <class Pixel>
Ripple measure_ripple(const RowContext& context, RowScratch& scratch, int channel);

// Takes the ripple out of a row's phases.
void correct_ripple_row(const Ripple& ripple, int row, int rows, int cols, float* turn);

}  // namespace beltpick::decode
