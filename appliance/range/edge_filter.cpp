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

// Three rows with a margin, and the extremes of each column of the three.
struct Window {
  const float *za, *zh, *zb;  // depth above, here, below
  const float *ma, *mh, *mb;  // modulation
  const float* step_mm;
};

[[gnu::always_inline]] inline void judge_pixels(const Window& w, int first, int count, std::uint8_t* __restrict flies) {
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

// Whether any of `count` pixels may fly: all nine depths around a pixel are measured and differ by less than a step
// where none can.
[[gnu::always_inline]] inline bool rough(const Window& w, const float* lowest, const float* highest, int first,
                                         int count) {
  int any = 0;
  for (int c = 0; c < count; ++c) {
    const int i = first + c + 1;
    const float low = std::min(std::min(lowest[i - 1], lowest[i + 1]), lowest[i]);
    const float high = std::max(std::max(highest[i - 1], highest[i + 1]), highest[i]);
    const int smooth = (low > 0.0F) & (high - low <= w.step_mm[i]);
    any |= 1 - smooth;
  }
  return any != 0;
}

// Columns 1 .. count of rows with a margin.
BELTPICK_KERNEL
void judge_row(const Window& window, int count, float* __restrict lowest, float* __restrict highest,
               std::uint8_t* __restrict flies) {
  const Window w = window;
  for (int i = 0; i < count + 2; ++i) {
    lowest[i] = std::min(std::min(w.za[i], w.zb[i]), w.zh[i]);
    highest[i] = std::max(std::max(w.za[i], w.zb[i]), w.zh[i]);
  }
  int first = 0;
  for (; first + kBlock <= count; first += kBlock) {
    if (rough(w, lowest, highest, first, kBlock)) {
      judge_pixels(w, first, kBlock, flies);
    } else {
      for (int c = 0; c < kBlock; ++c) flies[first + c] = 0;
    }
  }
  judge_pixels(w, first, count - first, flies);
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
  }
  lowest_mm_ = arena.take<float>("range scratch", width);
  highest_mm_ = arena.take<float>("range scratch", width);
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
  judge_row({above.depth_mm.data(), here.depth_mm.data(), below.depth_mm.data(), above.modulation.data(),
             here.modulation.data(), below.modulation.data(), here.step_mm.data()},
            cols_, lowest_mm_.data(), highest_mm_.data(), flies_.data());
  return flies_.first(static_cast<std::size_t>(cols_));
}

std::span<const std::uint8_t> EdgeFilter::push(const float* depth_mm, const float* sigma_mm, const float* modulation) {
  const Row& row = row_at(pushed_);
  load_row(depth_mm, sigma_mm, modulation, cols_, steepest_, row.depth_mm.data(), row.modulation.data(),
           row.step_mm.data());
  ++pushed_;
  return pushed_ < 2 ? std::span<const std::uint8_t>{} : judge(pushed_ - 2);
}

std::span<const std::uint8_t> EdgeFilter::last() {
  const Row& below = row_at(pushed_);
  std::fill(below.depth_mm.begin(), below.depth_mm.end(), 0.0F);
  return judge(pushed_ - 1);
}

}  // namespace beltpick::range
