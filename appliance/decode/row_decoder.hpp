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

// Where a finished row goes; x_px of an axis that is not coded is null.
struct RowOutput {
  std::array<float*, 2> x_px{};  // by Axis
  float* modulation = nullptr;
  PixelState* state = nullptr;
  std::uint8_t* texture = nullptr;
};

// Scratch for one row, taken once.
struct RowScratch {
  RowScratch() = default;
  RowScratch(Arena& arena, int cols);

  std::array<std::span<float>, kMaxPeriods> turn, amplitude8;
  std::span<float> mean8, half8;
  std::span<std::uint8_t> bits;           // rows of Gray bits that waited for their threshold
  std::span<std::uint16_t> level, reach;  // that threshold, as 8- or 16-bit levels
  std::span<std::uint16_t> cell;          // see cells_row()
  std::span<std::uint8_t> weak, order_safe;
  std::span<std::uint16_t> runs;                    // see refine_cells_row()
  std::array<std::span<float>, 2> x_px;             // of a further exposure, by Axis
  std::array<std::span<float>, 3> axis_amplitude8;  // of a further exposure by Axis, and of the second axis
  std::array<std::span<PixelState>, 3> axis_state;
  std::array<std::span<float>, 2> weight;  // by Axis: of the exposures merged so far
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
  TwinMargins twin_margins;
  MidpointReaches midpoint_reaches;
  std::span<Ripple> ripples;  // by channel; filled when the last frame is there
  // By exposure and axis: the usual amplitude of fringes over half the contrast (or the mean light) of their pixel.
  std::array<std::array<float, 2>, kMaxExposures> usual_contrast{};

  [[nodiscard]] float to_level8() const { return 255.0F / static_cast<float>(full_scale); }
};

template <class Pixel>
void fold_row(const RowContext& context, const FrameWork& work, const Pixel* levels, int row);

// The median contrast of an axis in one exposure, over some rows; 0 where it says nothing: without Gray code beside the
// fringes, or with too few pixels.
template <class Pixel>
float measure_contrast(const RowContext& context, RowScratch& scratch, const ExposurePlan& exposure,
                       const AxisPlan& axis);

// Fills `out`. Each step is one kernel over the row's pixels, from and to scratch that stays in the first-level cache;
// a further step (a correction of `turn`, another reason in `state`) is a kernel more in decode_axis() of
// finish_row.cpp.
template <class Pixel>
void finish_row(const RowContext& context, RowScratch& scratch, int row, const RowOutput& out);

}  // namespace beltpick::decode
