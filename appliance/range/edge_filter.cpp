#include "range/edge_filter.hpp"

#include <algorithm>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::range {
namespace {

// A surface seen at 75 degrees from its normal climbs this many footprints a pixel; a steeper one is hardly measured.
constexpr float kSteepest = 3.73F;
constexpr float kNoiseSigmas = 5.0F;
constexpr float kDiagonal = 1.4142F;
constexpr float kLeastCovered = 0.5F;

// What the two opposite neighbours of a line say about the pixel between them.
struct LineVerdict {
  int support;  // neighbours on the pixel's surface
  int flies;
};

[[gnu::always_inline]] inline LineVerdict judge_line(float z, float modulation, float step_mm, float z1, float z2,
                                                     float modulation1, float modulation2) {
  const float to1 = z1 - z;
  const float to2 = z2 - z;
  const int on1 = (z1 > 0.0F) & (std::fabs(to1) <= step_mm);
  const int on2 = (z2 > 0.0F) & (std::fabs(to2) <= step_mm);
  const int between =
      (z1 > 0.0F) & (z2 > 0.0F) & (((to1 > step_mm) & (to2 < -step_mm)) | ((to1 < -step_mm) & (to2 > step_mm)));
  const int uncovered = (on1 & (1 - on2) & (modulation < kLeastCovered * modulation1)) |
                        (on2 & (1 - on1) & (modulation < kLeastCovered * modulation2));
  return {on1 + on2, between | uncovered};
}

// Columns 1 .. count of rows with a margin.
BELTPICK_KERNEL
void judge_row(const float* __restrict za, const float* __restrict zh, const float* __restrict zb,
               const float* __restrict ma, const float* __restrict mh, const float* __restrict mb,
               const float* __restrict step_mm, int count, std::uint8_t* __restrict flies) {
  for (int c = 0; c < count; ++c) {
    const int i = c + 1;
    const float z = zh[i];
    const float m = mh[i];
    const float s = step_mm[i];
    const LineVerdict across = judge_line(z, m, s, zh[i - 1], zh[i + 1], mh[i - 1], mh[i + 1]);
    const LineVerdict down = judge_line(z, m, s, za[i], zb[i], ma[i], mb[i]);
    const LineVerdict falling = judge_line(z, m, kDiagonal * s, za[i - 1], zb[i + 1], ma[i - 1], mb[i + 1]);
    const LineVerdict rising = judge_line(z, m, kDiagonal * s, za[i + 1], zb[i - 1], ma[i + 1], mb[i - 1]);
    const int support = across.support + down.support + falling.support + rising.support;
    const int alone = support < 2 ? 1 : 0;
    const int measured = z > 0.0F ? 1 : 0;
    flies[c] = static_cast<std::uint8_t>(measured & (alone | across.flies | down.flies | falling.flies | rising.flies));
  }
}

}  // namespace

EdgeFilter::EdgeFilter(Arena& arena, int cols) {
  const auto width = static_cast<std::size_t>(cols) + 2;
  for (Row& row : rows_) {
    row.depth_mm = arena.take<float>("range scratch", width);
    row.modulation = arena.take<float>("range scratch", width);
    row.step_mm = arena.take<float>("range scratch", width);
  }
  flies_ = arena.take<std::uint8_t>("range scratch", width);
}

void EdgeFilter::load_row(const RangeImage& range, ImageView<const float> modulation, int row, float focal_px) {
  Row& loaded = row_at(row);
  std::fill(loaded.depth_mm.begin(), loaded.depth_mm.end(), 0.0F);
  if (row < 0 || row >= range.point_mm.rows) return;
  for (int c = 0; c < range.point_mm.cols; ++c) {
    const float z = range.point_mm(row, c).z();
    const auto at = static_cast<std::size_t>(c) + 1;
    loaded.depth_mm[at] = z;
    loaded.modulation[at] = modulation(row, c);
    loaded.step_mm[at] = std::max(kSteepest * z / focal_px, kNoiseSigmas * range.sigma_mm(row, c));
  }
}

int EdgeFilter::apply(const RangeImage& range, ImageView<const float> modulation, float focal_px) {
  int dropped = 0;
  load_row(range, modulation, -1, focal_px);
  load_row(range, modulation, 0, focal_px);
  for (int row = 0; row < range.point_mm.rows; ++row) {
    load_row(range, modulation, row + 1, focal_px);
    const Row& above = row_at(row - 1);
    const Row& here = row_at(row);
    const Row& below = row_at(row + 1);
    judge_row(above.depth_mm.data(), here.depth_mm.data(), below.depth_mm.data(), above.modulation.data(),
              here.modulation.data(), below.modulation.data(), here.step_mm.data(), range.point_mm.cols, flies_.data());
    for (int c = 0; c < range.point_mm.cols; ++c) {
      if (flies_[static_cast<std::size_t>(c)] == 0) continue;
      range.point_mm(row, c).setZero();
      range.sigma_mm(row, c) = 0.0F;
      ++dropped;
    }
  }
  return dropped;
}

}  // namespace beltpick::range
