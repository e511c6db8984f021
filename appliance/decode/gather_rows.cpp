#include "decode/gather_rows.hpp"

#include <array>

#include "decode/finish_kernels.hpp"
#include "decode/gray_cells.hpp"
#include "decode/gray_rows.hpp"
#include "decode/phase_kernels.hpp"
#include "decode/ripple.hpp"

namespace beltpick::decode {

template <class Pixel>
void gather_gray(const RowContext& context, const GrayCode& code, RowScratch& scratch, int row) {
  std::array<const std::uint8_t*, kMaxGrayBits> bit_rows{};
  const std::size_t row_bytes = bit_row_bytes(context.cols);
  auto* level = reinterpret_cast<Pixel*>(scratch.level.data());
  auto* reach = reinterpret_cast<Pixel*>(scratch.reach.data());
  const Threshold* made = nullptr;
  for (std::size_t b = 0; b < code.bits.size(); ++b) {
    const GrayBit& bit = code.bits[b];
    if (bit.raw_plane == kNone) {
      bit_rows[b] = context.store.row<const std::uint8_t>(bit.plane, row);
      continue;
    }
    if (made == nullptr || !(*made == bit.threshold)) {
      threshold_row(context, code, bit.threshold, row, level, reach);
      made = &bit.threshold;
    }
    std::uint8_t* bits = scratch.bits.data() + b * row_bytes;
    resolve_levels_row(context.store.row<const Pixel>(bit.raw_plane, row), level, reach, context.cols,
                       bit.frame == kNone, bits);
    bit_rows[b] = bits;
  }
  cells_row(bit_rows, static_cast<int>(code.bits.size()), context.cols, scratch.cell.data(), scratch.weak.data());
}

template <class Pixel>
void gather_levels(const RowContext& context, const Reference& reference, RowScratch& scratch, int row) {
  const float scale = reference.scale * context.to_level8();
  float* mean8 = scratch.mean8.data();
  float* half8 = scratch.half8.data();
  if (reference.mean_channel != kNone) {
    const PhaseChannel& fringes = context.plan->channels[static_cast<std::size_t>(reference.mean_channel)];
    levels_row(context.store.row<const MeanOf<Pixel>>(fringes.mean_plane, row), context.cols,
               context.to_level8() / static_cast<float>(fringes.frames), mean8, half8);
    return;
  }
  levels_row(context.store.row<const Pixel>(reference.white_plane, row),
             context.store.row<const Pixel>(reference.black_plane, row), context.cols, scale, mean8, half8);
}

namespace {

template <class Pixel>
void read_phase(const RowContext& context, int channel, int row, int first, int count, float* turn, float* amplitude8) {
  using Sum = std::conditional_t<sizeof(Pixel) == 1, std::int16_t, float>;
  const PhaseChannel& fringes = context.plan->channels[static_cast<std::size_t>(channel)];
  const double levels_per_count = sizeof(Pixel) == 1 ? 1.0 / fringes.counts_per_level : 1.0;
  fringe_row(context.store.row<const Sum>(fringes.cosine_plane, row) + first,
             context.store.row<const Sum>(fringes.sine_plane, row) + first, count,
             static_cast<float>(levels_per_count) * context.to_level8(), turn, amplitude8);
}

}  // namespace

template <class Pixel>
void gather_phase(const RowContext& context, int channel, std::span<float> turn, std::span<float> amplitude8, int row) {
  read_phase<Pixel>(context, channel, row, 0, context.cols, turn.data(), amplitude8.data());
}

template <class Pixel>
Phase phase_at(const RowContext& context, int channel, int row, int col) {
  Phase phase{};
  read_phase<Pixel>(context, channel, row, col, 1, &phase.turn, &phase.amplitude8);
  return phase;
}

template <class Pixel>
void gather_fringe(const RowContext& context, int channel, std::span<float> turn, std::span<float> amplitude8,
                   int row) {
  gather_phase<Pixel>(context, channel, turn, amplitude8, row);
  const Ripple& ripple = context.ripples[static_cast<std::size_t>(channel)];
  if (ripple.orders > 0) correct_ripple_row(ripple, row, context.rows, context.cols, turn.data());
}

template void gather_gray<std::uint8_t>(const RowContext&, const GrayCode&, RowScratch&, int);
template void gather_gray<std::uint16_t>(const RowContext&, const GrayCode&, RowScratch&, int);
template void gather_levels<std::uint8_t>(const RowContext&, const Reference&, RowScratch&, int);
template void gather_levels<std::uint16_t>(const RowContext&, const Reference&, RowScratch&, int);
template void gather_phase<std::uint8_t>(const RowContext&, int, std::span<float>, std::span<float>, int);
template void gather_phase<std::uint16_t>(const RowContext&, int, std::span<float>, std::span<float>, int);
template Phase phase_at<std::uint8_t>(const RowContext&, int, int, int);
template Phase phase_at<std::uint16_t>(const RowContext&, int, int, int);
template void gather_fringe<std::uint8_t>(const RowContext&, int, std::span<float>, std::span<float>, int);
template void gather_fringe<std::uint16_t>(const RowContext&, int, std::span<float>, std::span<float>, int);

}  // namespace beltpick::decode
