// One Gray frame of one row against its threshold, whether it is resolved on arrival or at the end. Internal to decode.
#pragma once

#include <type_traits>

#include "decode/fold_kernels.hpp"
#include "decode/row_decoder.hpp"

namespace beltpick::decode {

template <class Pixel>
using MeanOf = std::conditional_t<sizeof(Pixel) == 1, std::uint16_t, float>;

template <class Pixel>
void resolve_bit_row(const RowContext& context, const GrayCode& code, const ResolveBit& work, const Pixel* levels,
                     int row, std::uint16_t* bits, std::uint16_t* weak) {
  const Threshold& threshold = code.bits[static_cast<std::size_t>(work.bit)].threshold;
  BitRule rule{.mask = static_cast<std::uint16_t>(1U << static_cast<unsigned>(work.bit)),
               .inverted = work.inverted,
               .first = work.first,
               .to_level8 = context.to_level8(),
               .scale = threshold.scale,
               .weak_fraction = code.weak_fraction};
  switch (threshold.kind) {
    case ThresholdKind::kTwin: {
      rule.noise_factor = 0.5F;  // half the difference of two frames
      rule.inverted = false;
      const Pixel* other = context.store.row<const Pixel>(threshold.plane, row);
      const Pixel* upright = work.inverted ? other : levels;
      const Pixel* inverted = work.inverted ? levels : other;
      resolve_twin_row(upright, inverted, context.cols, rule, bits, weak);
      return;
    }
    case ThresholdKind::kMidpoint:
      rule.noise_factor = 1.5F;  // one frame against the mean of two
      resolve_midpoint_row(levels, context.store.row<Pixel>(threshold.plane, row),
                           context.store.row<Pixel>(threshold.black_plane, row), context.cols, rule, bits, weak);
      return;
    case ThresholdKind::kMean:
      rule.noise_factor = 1.0F + threshold.scale;  // one frame against the mean of N: scale = 1 / N
      resolve_mean_row(levels, context.store.row<MeanOf<Pixel>>(threshold.plane, row), context.cols, rule, bits, weak);
      return;
  }
}

}  // namespace beltpick::decode
