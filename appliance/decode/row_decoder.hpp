// RowDecoder: folds and finishes one image row of a plan's state. Pixel is the camera's: std::uint8_t or std::uint16_t.
// Internal to decode.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "decode/plan.hpp"
#include "decode/plane_store.hpp"
#include "decode/ripple_kernels.hpp"

namespace beltpick::decode {

inline constexpr std::size_t kMaxPeriods = 8;  // of one axis

// One axis of one row.
struct AxisRow {
  std::span<float> x_px, amplitude8;
  std::span<PixelState> state;
};

// Scratch for one row, taken once.
struct RowScratch {
  RowScratch() = default;
  RowScratch(Arena& arena, int cols);

  std::array<std::span<float>, kMaxPeriods> turn, amplitude8;
  std::span<float> mean8, half8;
  std::span<std::uint16_t> code, weak;
  std::span<std::uint8_t> order_safe;
  AxisRow current;
  std::array<AxisRow, 2> best;  // by Axis: the best exposure of each pixel
};

inline constexpr std::size_t kRippleTerms = 6;

// The correction of one channel's phases: for each order m an amplitude over the image, in turns, as
// a0 + a1 x + a2 y + a3 x^2 + a4 x y + a5 y^2 with x and y from -1 to 1, between 0 and its limit. See ripple.hpp.
struct Ripple {
  int steps = 0;
  int orders = 0;  // 0: none to correct
  float offset_turns = 0.0F;
  std::array<std::array<float, kRippleTerms>, kRippleOrders> amplitude_turns{};
  std::array<float, kRippleOrders> limit_turns{};
};

// What a capture's rows have in common.
struct RowContext {
  const FoldPlan* plan = nullptr;
  PlaneStore store;
  int rows = 0;
  int cols = 0;
  int full_scale = 255;
  std::span<Ripple> ripples;  // by channel; filled when the last frame is there

  [[nodiscard]] float to_level8() const { return 255.0F / static_cast<float>(full_scale); }
};

template <class Pixel>
void fold_row(const RowContext& context, const FrameWork& work, const Pixel* levels, int row);

// Fills scratch.best of every coded axis, and `texture`.
template <class Pixel>
void finish_row(const RowContext& context, RowScratch& scratch, int row, std::uint8_t* texture);

}  // namespace beltpick::decode
