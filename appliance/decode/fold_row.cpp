#include <algorithm>

#include "decode/bit_kernels.hpp"
#include "decode/fold_kernels.hpp"
#include "decode/gray_rows.hpp"
#include "decode/phase_kernels.hpp"
#include "decode/row_decoder.hpp"

namespace beltpick::decode {
namespace {

template <class Pixel>
using SumOf = std::conditional_t<sizeof(Pixel) == 1, std::int16_t, float>;

// The phase frames that are added now: the one that has arrived and those that waited for it.
template <class Pixel>
FringeRows<Pixel> frames_together(const RowContext& context, const Accumulate& work, const Pixel* levels, int row) {
  FringeRows<Pixel> rows{.count = work.together,
                         .first = work.first,
                         .first_flags = work.first_flags,
                         .full_scale = context.full_scale,
                         .saturation_bit = work.saturation_bit};
  const auto set = [&](std::size_t n, const Accumulate& frame, const Pixel* pixels) {
    rows.levels[n] = pixels;
    rows.cosine_weight[n] = frame.cosine_weight;
    rows.sine_weight[n] = frame.sine_weight;
    rows.cosine_weight_q15[n] = frame.cosine_weight_q15;
    rows.sine_weight_q15[n] = frame.sine_weight_q15;
  };
  const auto last = static_cast<std::size_t>(work.together) - 1;
  for (std::size_t n = 0; n < last; ++n) {
    const FrameWork& waited = context.plan->frames[static_cast<std::size_t>(work.earlier[n])];
    set(n, waited.accumulate, context.store.row<const Pixel>(waited.keep_plane, row));
  }
  set(last, work, levels);
  return rows;
}

template <class Pixel>
void accumulate(const RowContext& context, const Accumulate& work, const Pixel* levels, int row) {
  const PhaseChannel& channel = context.plan->channels[static_cast<std::size_t>(work.channel)];
  auto* cosine = context.store.row<SumOf<Pixel>>(channel.cosine_plane, row);
  auto* sine = context.store.row<SumOf<Pixel>>(channel.sine_plane, row);
  accumulate_row(frames_together(context, work, levels, row), context.cols, cosine, sine,
                 context.store.row<MeanOf<Pixel>>(channel.mean_plane, row),
                 context.store.row<std::uint8_t>(context.plan->flags_plane, row));
  if (work.last) phase_row(cosine, sine, context.cols);
}

template <class Pixel>
void resolve(const RowContext& context, const ResolveBit& work, const Pixel* levels, int row) {
  const GrayCode& code = context.plan->grays[static_cast<std::size_t>(work.gray)];
  const GrayBit& bit = code.bits[static_cast<std::size_t>(work.bit)];
  auto* bits = context.store.row<std::uint8_t>(bit.plane, row);
  if (bit.threshold.kind == ThresholdKind::kTwin) {
    resolve_twins_row(context, code, work, levels, row, bits);
    return;
  }
  auto* level = context.store.row<Pixel>(bit.threshold.level_plane, row);
  auto* reach = context.store.row<Pixel>(bit.threshold.reach_plane, row);
  if (work.prepare_threshold) threshold_row(context, code, bit.threshold, row, level, reach);
  resolve_levels_row(levels, level, reach, context.cols, work.inverted, bits);
}

}  // namespace

template <class Pixel>
void fold_row(const RowContext& context, const FrameWork& work, const Pixel* levels, int row) {
  if (work.accumulate.together > 0) accumulate(context, work.accumulate, levels, row);
  if (work.keep_plane != kNone) {
    std::copy_n(levels, context.cols, context.store.row<Pixel>(work.keep_plane, row));
  }
  if (work.resolve.gray != kNone) resolve(context, work.resolve, levels, row);
  if (work.extremes.white_plane != kNone) {
    widen_extremes_row(levels, context.cols, work.first_extremes,
                       context.store.row<Pixel>(work.extremes.white_plane, row),
                       context.store.row<Pixel>(work.extremes.black_plane, row));
  }
}

template void fold_row(const RowContext&, const FrameWork&, const std::uint8_t*, int);
template void fold_row(const RowContext&, const FrameWork&, const std::uint16_t*, int);

}  // namespace beltpick::decode
