#include "range/edge_filter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::range {
namespace {

// A surface seen at 75 degrees from its normal climbs this many footprints a pixel; a steeper one is hardly measured.
constexpr float kSteepest = 3.73F;
constexpr float kNoiseSigmas = 5.0F;
constexpr float kDiagonal = 1.4142F;
constexpr float kLeastCovered = 0.5F;
constexpr int kBlock = 64;

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

// Three rows with a margin.
struct Window {
  const float *za, *zh, *zb;  // depth above, here, below
  const float *ma, *mh, *mb;  // modulation
  const float* step_mm;
};

BELTPICK_KERNEL
void judge_pixels(const Window& window, int first, int count, std::uint8_t* __restrict flies) {
  const Window w = window;
  for (int c = 0; c < count; ++c) {
    const int i = first + c + 1;
    const float z = w.zh[i];
    const float m = w.mh[i];
    const float s = w.step_mm[i];
    const LineVerdict across = judge_line(z, m, s, w.zh[i - 1], w.zh[i + 1], w.mh[i - 1], w.mh[i + 1]);
    const LineVerdict down = judge_line(z, m, s, w.za[i], w.zb[i], w.ma[i], w.mb[i]);
    const LineVerdict falling = judge_line(z, m, kDiagonal * s, w.za[i - 1], w.zb[i + 1], w.ma[i - 1], w.mb[i + 1]);
    const LineVerdict rising = judge_line(z, m, kDiagonal * s, w.za[i + 1], w.zb[i - 1], w.ma[i + 1], w.mb[i - 1]);
    const int support = across.support + down.support + falling.support + rising.support;
    const int alone = support < 2 ? 1 : 0;
    const int measured = z > 0.0F ? 1 : 0;
    flies[first + c] =
        static_cast<std::uint8_t>(measured & (alone | across.flies | down.flies | falling.flies | rising.flies));
  }
}

// Of a block of columns: whether along the row, or to the row above, a depth steps by more than kSmoothShare of what
// the steepest surface climbs in a pixel. From a pixel to any of its neighbours lead one step down and one across, so
// where all are smaller, all nine depths differ by less than a step, and the pixel does not fly.
constexpr float kSmoothShare = 0.24F;  // a quarter, less what the depths themselves differ by
constexpr std::uint8_t kAlong = 1, kDown = 2;

[[gnu::always_inline]] inline std::uint8_t roughness(const float* z, const float* above, int count, float smooth) {
  // Sign bits: what is left of the most a depth may step is negative where it steps more.
  std::int32_t along = 0;
  std::int32_t down = 0;
  for (int i = 0; i < count; ++i) {
    const float most_mm = smooth * z[i];
    along |= std::bit_cast<std::int32_t>(most_mm - std::fabs(z[i] - z[i - 1]));
    down |= std::bit_cast<std::int32_t>(most_mm - std::fabs(z[i] - above[i]));
  }
  return static_cast<std::uint8_t>((along < 0 ? kAlong : 0) | (down < 0 ? kDown : 0));
}

// The blocks of columns 1 .. count of a row with a margin, and of the one above it.
BELTPICK_KERNEL
void find_rough(float* depth_mm, const float* above_mm, int count, float smooth, std::uint8_t* rough) {
  const float* z = depth_mm + 1;
  const float* above = above_mm + 1;
  depth_mm[0] = z[0];  // the step from beyond the border is none
  for (int first = 0; first < count; first += kBlock) {
    *rough++ = first + kBlock <= count ? roughness(z + first, above + first, kBlock, smooth)
                                       : roughness(z + first, above + first, count - first, smooth);
  }
  depth_mm[0] = 0.0F;
}

// Columns 1 .. count of rows with a margin.
BELTPICK_KERNEL
void load_row(const float* __restrict depth_mm, const float* __restrict sigma_mm, const float* __restrict modulation,
              int count, float steepest, float* __restrict depth_out, float* __restrict modulation_out,
              float* __restrict step_out) {
  for (int c = 0; c < count; ++c) {
    depth_out[c + 1] = depth_mm[c];
    modulation_out[c + 1] = modulation[c];
    step_out[c + 1] = std::max(steepest * depth_mm[c], kNoiseSigmas * sigma_mm[c]);
  }
}

}  // namespace

EdgeFilter::EdgeFilter(Arena& arena, int cols) {
  const auto width = static_cast<std::size_t>(cols) + 2;
  for (Row& row : rows_) {
    row.depth_mm = arena.take<float>("range scratch", width);
    row.modulation = arena.take<float>("range scratch", width);
    row.step_mm = arena.take<float>("range scratch", width);
    row.rough = arena.take<std::uint8_t>("range scratch", width / kBlock + 2);
  }
  flies_ = arena.take<std::uint8_t>("range scratch", width);
}

void EdgeFilter::begin(int cols, float focal_px) {
  cols_ = cols;
  steepest_ = kSteepest / focal_px;
  pushed_ = 0;
  for (const Row& row : rows_) std::fill(row.depth_mm.begin(), row.depth_mm.end(), 0.0F);
}

std::span<const std::uint8_t> EdgeFilter::judge(int row) {
  const Row& above = row_at(row - 1);
  const Row& here = row_at(row);
  const Row& below = row_at(row + 1);
  const Window window{above.depth_mm.data(),  here.depth_mm.data(),    below.depth_mm.data(), above.modulation.data(),
                      here.modulation.data(), below.modulation.data(), here.step_mm.data()};
  std::fill_n(flies_.begin(), cols_, std::uint8_t{0});
  const int blocks = (cols_ + kBlock - 1) / kBlock;
  for (int b = 0; b < blocks; ++b) {
    const auto at = static_cast<std::size_t>(b);
    // The step from a block's last pixel to its neighbour is the next block's.
    const auto along = [&](const Row& r) { return (r.rough[at] | (b + 1 < blocks ? r.rough[at + 1] : 0)) & kAlong; };
    const int down = (here.rough[at] | below.rough[at]) & kDown;
    if ((along(above) | along(here) | along(below) | down) == 0) continue;
    judge_pixels(window, b * kBlock, std::min(kBlock, cols_ - b * kBlock), flies_.data());
  }
  // Beyond the image's border there is nothing, which only the pixels there see.
  judge_pixels(window, 0, 1, flies_.data());
  judge_pixels(window, cols_ - 1, 1, flies_.data());
  return flies_.first(static_cast<std::size_t>(cols_));
}

std::span<const std::uint8_t> EdgeFilter::push(const float* depth_mm, const float* sigma_mm, const float* modulation) {
  const Row& row = row_at(pushed_);
  load_row(depth_mm, sigma_mm, modulation, cols_, steepest_, row.depth_mm.data(), row.modulation.data(),
           row.step_mm.data());
  find_rough(row.depth_mm.data(), row_at(pushed_ - 1).depth_mm.data(), cols_, kSmoothShare * steepest_,
             row.rough.data());
  // Beyond the margin there is no step.
  if (pushed_ == 0) std::fill(row.rough.begin(), row.rough.end(), kAlong);
  ++pushed_;
  return pushed_ < 2 ? std::span<const std::uint8_t>{} : judge(pushed_ - 2);
}

std::span<const std::uint8_t> EdgeFilter::last() {
  const Row& below = row_at(pushed_);
  std::fill(below.depth_mm.begin(), below.depth_mm.end(), 0.0F);
  std::fill(below.rough.begin(), below.rough.end(), kAlong);
  return judge(pushed_ - 1);
}

}  // namespace beltpick::range
