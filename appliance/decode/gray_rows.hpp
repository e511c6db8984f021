// One Gray frame of one row against its threshold, whether it is resolved on arrival or at the end. Internal to decode.
#pragma once

#include <type_traits>

#include "decode/bit_kernels.hpp"
#include "decode/row_decoder.hpp"

namespace beltpick::decode {

template <class Pixel>
using MeanOf = std::conditional_t<sizeof(Pixel) == 1, std::uint16_t, float>;

// The threshold of a bit that has no twin, in whole levels.
template <class Pixel>
void threshold_row(const RowContext& context, const GrayCode& code, const Threshold& threshold, int row, Pixel* level,
                   Pixel* reach) {
  ThresholdRule rule{.to_level8 = context.to_level8(),
                     .scale = threshold.scale,
                     .weak_fraction = code.weak_fraction,
                     .midpoint_reaches = &context.midpoint_reaches};
  if (threshold.kind == ThresholdKind::kMidpoint) {
    rule.noise_factor = kMidpointNoiseFactor;
    midpoint_threshold_row(context.store.row<const Pixel>(threshold.plane, row),
                           context.store.row<const Pixel>(threshold.black_plane, row), context.cols, rule, level,
                           reach);
  } else {
    rule.noise_factor = 1.0F + threshold.scale;  // one frame against the mean of N: scale = 1 / N
    mean_threshold_row(context.store.row<const MeanOf<Pixel>>(threshold.plane, row), context.cols, rule, level, reach);
  }
}

// The bit of a frame and its twin, of which `levels` came last.
template <class Pixel>
void resolve_twins_row(const RowContext& context, const GrayCode& code, const ResolveBit& work, const Pixel* levels,
                       int row, std::uint8_t* bits) {
  const Threshold& threshold = code.bits[static_cast<std::size_t>(work.bit)].threshold;
  const ThresholdRule rule{.to_level8 = context.to_level8(),
                           .noise_factor = kTwinNoiseFactor,
                           .weak_fraction = code.weak_fraction,
                           .twin_margins = &context.twin_margins};
  const Pixel* other = context.store.row<const Pixel>(threshold.plane, row);
  resolve_twin_row(work.inverted ? other : levels, work.inverted ? levels : other, context.cols, rule, bits);
}

}  // namespace beltpick::decode
