#include <algorithm>

#include "decode/fold_kernels.hpp"
#include "decode/gray_rows.hpp"
#include "decode/row_decoder.hpp"

namespace beltpick::decode {
namespace {

template <class Pixel>
using SumOf = std::conditional_t<sizeof(Pixel) == 1, std::int16_t, float>;

template <class Pixel>
void accumulate(const RowContext& context, const Accumulate& work, const Pixel* levels, int row) {
  const PhaseChannel& channel = context.plan->channels[static_cast<std::size_t>(work.channel)];
  accumulate_row(levels, context.cols, work, context.store.row<SumOf<Pixel>>(channel.cosine_plane, row),
                 context.store.row<SumOf<Pixel>>(channel.sine_plane, row));
  if (channel.mean_plane != kNone) {
    accumulate_mean_row(levels, context.cols, work.first, context.store.row<MeanOf<Pixel>>(channel.mean_plane, row));
  }
  flag_saturation_row(levels, context.cols, context.full_scale, work.saturation_bit, work.first_flags,
                      context.store.row<std::uint8_t>(context.plan->flags_plane, row));
}

}  // namespace

template <class Pixel>
void fold_row(const RowContext& context, const FrameWork& work, const Pixel* levels, int row) {
  if (work.accumulate.channel != kNone) accumulate(context, work.accumulate, levels, row);
  if (work.keep_plane != kNone) {
    std::copy_n(levels, context.cols, context.store.row<Pixel>(work.keep_plane, row));
  }
  if (work.resolve.gray != kNone) {
    const GrayCode& code = context.plan->grays[static_cast<std::size_t>(work.resolve.gray)];
    resolve_bit_row(context, code, work.resolve, levels, row, context.store.row<std::uint16_t>(code.code_plane, row),
                    context.store.row<std::uint16_t>(code.weak_plane, row));
  }
  if (work.extremes.white_plane != kNone) {
    widen_extremes_row(levels, context.cols, work.first_extremes,
                       context.store.row<Pixel>(work.extremes.white_plane, row),
                       context.store.row<Pixel>(work.extremes.black_plane, row));
  }
}

template void fold_row(const RowContext&, const FrameWork&, const std::uint8_t*, int);
template void fold_row(const RowContext&, const FrameWork&, const std::uint16_t*, int);

}  // namespace beltpick::decode
