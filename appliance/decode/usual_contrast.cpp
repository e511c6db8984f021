// How much of their pixels' contrast the fringes of a capture usually have.
#include <algorithm>
#include <array>

#include "decode/gather_rows.hpp"

namespace beltpick::decode {

template <class Pixel>
float measure_contrast(const RowContext& context, RowScratch& scratch, const ExposurePlan& exposure,
                       const AxisPlan& axis) {
  constexpr int kRows = 24;
  constexpr std::size_t kColsApart = 3;  // neighbours tell the same
  constexpr int kBins = 128;
  constexpr float kLeastAmplitude8 = 10.0F;
  constexpr int kLeastPixels = 200;
  if (axis.method != Method::kGrayPhase) return 0.0F;
  std::array<int, kBins> counts{};
  int all = 0;
  for (int row = 0; row < context.rows; row += std::max(1, context.rows / kRows)) {
    gather_levels<Pixel>(context, exposure.reference, scratch, row);
    gather_fringe<Pixel>(context, axis.channels[0], scratch.turn[0], scratch.amplitude8[0], row);
    const auto* flags = context.store.row<const std::uint8_t>(context.plan->flags_plane, row);
    for (std::size_t i = 0; i < static_cast<std::size_t>(context.cols); i += kColsApart) {
      if (scratch.amplitude8[0][i] < kLeastAmplitude8 || (flags[i] & exposure.saturation_bit) != 0) continue;
      const float contrast = scratch.amplitude8[0][i] / std::max(scratch.half8[i], 1.0F);
      ++counts[static_cast<std::size_t>(std::min(contrast * 0.5F, 0.999F) * kBins)];
      ++all;
    }
  }
  if (all < kLeastPixels) return 0.0F;
  int below = 0;
  std::size_t bin = 0;
  while (2 * (below += counts[bin]) < all) ++bin;
  return 2.0F * (static_cast<float>(bin) + 0.5F) / kBins;
}

template float measure_contrast<std::uint8_t>(const RowContext&, RowScratch&, const ExposurePlan&, const AxisPlan&);
template float measure_contrast<std::uint16_t>(const RowContext&, RowScratch&, const ExposurePlan&, const AxisPlan&);

}  // namespace beltpick::decode
