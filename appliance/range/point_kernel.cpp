#include "range/point_kernel.hpp"

#include "base/kernel.hpp"
#include "range/point_block.hpp"

namespace beltpick::range {

BELTPICK_KERNEL
RowCounts settle_row(float* __restrict depth_mm, const std::uint8_t* __restrict flies, PixelState* __restrict state,
                     int count) {
  // Bytes in passes of their own: beside them the compiler would take four vectors of floats at a time.
  RowCounts counts;
  for (int i = 0; i < count; ++i) {
    counts.flying += flies[i];
    counts.coded += state[i] == PixelState::kValid ? 1 : 0;
  }
  if (counts.flying > 0) {
    for (int i = 0; i < count; ++i) depth_mm[i] = flies[i] == 0 ? depth_mm[i] : 0.0F;
  }
  for (int i = 0; i < count; ++i) counts.points += depth_mm[i] > 0.0F ? 1 : 0;
  if (counts.points == counts.coded) return counts;
  for (int i = 0; i < count; ++i) {
    const auto contradicted = static_cast<int>(depth_mm[i] > 0.0F ? PixelState::kValid : PixelState::kOrderUncertain);
    const int reason = flies[i] != 0 ? static_cast<int>(PixelState::kEdge) : contradicted;
    state[i] = static_cast<PixelState>(state[i] == PixelState::kValid ? reason : static_cast<int>(state[i]));
  }
  return counts;
}

BELTPICK_KERNEL
void write_points(const PointRow& row, int count) {
  for (int at = 0; at < count; at += kBlock) write_block(row, at, count);
}

}  // namespace beltpick::range
