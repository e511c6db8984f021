#include "decode/gray_subpixel.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

constexpr int kLikeLength = 3;  // times longer or shorter, and two pixels, at most

// How the cell of a pixel follows that of the pixel to its left.
using Step = std::uint8_t;
constexpr Step kBreak = 0;  // not at all, or one of the two is not valid
constexpr Step kRise = 1;   // the next higher cell
constexpr Step kFall = 2;   // the next lower one
constexpr Step kSame = 4;   // the same cell: one run

template <class Lane>
BELTPICK_INLINE void take_steps_of(const std::uint16_t* __restrict cell, const PixelState* __restrict state, int first,
                                   int end, Lane* __restrict step) {
  for (int i = first; i < end; ++i) {
    const std::uint16_t higher = std::max(cell[i], cell[i - 1]);
    const std::uint16_t lower = std::min(cell[i], cell[i - 1]);
    const std::uint16_t next = cell[i] == higher ? kRise : kFall;
    const auto apart = static_cast<std::uint16_t>(higher - lower);
    const std::uint16_t moved = apart == 1 ? next : apart == 0 ? kSame : kBreak;
    const bool valid = state[i] == PixelState::kValid && state[i - 1] == PixelState::kValid;
    step[i] = valid ? static_cast<Lane>(moved) : Lane{kBreak};
  }
}

// Of pixels 1 on, in whole vectors: the last may take some pixels again.
template <class Lane>
BELTPICK_INLINE void take_steps(const std::uint16_t* cell, const PixelState* state, int count, Lane* step) {
  constexpr int kTogether = 64;
  step[0] = kBreak;
  if (count <= kTogether) {
    take_steps_of(cell, state, 1, count, step);
    return;
  }
  take_steps_of(cell, state, 1, 1 + (count - 1) / kTogether * kTogether, step);
  take_steps_of(cell, state, count - kTogether, count, step);
}

// Whether the pixel to the left, or to the right, is of the same run.
template <class Lane>
BELTPICK_INLINE void start_counts(const Lane* __restrict step, int count, Lane* __restrict before,
                                  Lane* __restrict after) {
  for (int i = 0; i < count; ++i) before[i] = step[i] == kSame ? 1 : 0;
  for (int i = 0; i < count; ++i) after[i] = step[i + 1] == kSame ? 1 : 0;
}

// The pixels whose neighbour at distance `reach` may lie beyond the margin of a row: it is not looked at, as their runs
// end before.
BELTPICK_INLINE int without_neighbour(int count, int reach) { return reach <= kRunMargin ? 0 : std::min(reach, count); }

// From counts up to `reach` to counts up to twice that; true where one is so high.
template <class Lane>
BELTPICK_INLINE bool double_before(const Lane* __restrict from, int count, int reach, Lane* __restrict to) {
  const auto full = static_cast<Lane>(reach);
  const int head = without_neighbour(count, reach);
  for (int i = 0; i < head; ++i) to[i] = from[i];
  Lane most = 0;
  for (int i = head; i < count; ++i) {
    const Lane further = from[i - reach];
    const Lane own = from[i];
    const auto sum = static_cast<Lane>(own + (own == full ? further : Lane{0}));
    most = std::max(most, sum);
    to[i] = sum;
  }
  return most == 2 * reach;
}
template <class Lane>
BELTPICK_INLINE void double_after(const Lane* __restrict from, int count, int reach, Lane* __restrict to) {
  const auto full = static_cast<Lane>(reach);
  const int tail = count - without_neighbour(count, reach);
  for (int i = 0; i < tail; ++i) {
    const Lane further = from[i + reach];
    const Lane own = from[i];
    to[i] = static_cast<Lane>(own + (own == full ? further : Lane{0}));
  }
  for (int i = tail; i < count; ++i) to[i] = from[i];
}

// Keeps the steps between runs of like length.
template <class Lane>
BELTPICK_INLINE void keep_like(const Lane* __restrict step, const Lane* __restrict before, const Lane* __restrict after,
                               int count, Lane* __restrict kept) {
  constexpr auto kShort = static_cast<Lane>((std::numeric_limits<Lane>::max() - 2) / kLikeLength);
  for (int i = 0; i < count; ++i) {
    const auto left = static_cast<Lane>(before[i - 1] + 1);
    const auto right = static_cast<Lane>(after[i] + 1);
    const Lane shorter = std::min(std::min(left, right), kShort);
    const auto most = static_cast<Lane>(kLikeLength * shorter + 2);
    const Lane border = step[i] == kSame ? Lane{kBreak} : step[i];
    kept[i] = std::max(left, right) <= most ? border : Lane{kBreak};
  }
}

// Each pixel takes over what stands `reach` pixels further to its run's start, or end, where the way is that long:
// after all powers of two, what stands at the start, or end.
template <class Lane>
BELTPICK_INLINE void fetch_start(const Lane* __restrict from, const Lane* __restrict before, int count, int reach,
                                 Lane* __restrict to) {
  const auto bit = static_cast<Lane>(reach);
  const int head = without_neighbour(count, reach);
  for (int i = 0; i < head; ++i) to[i] = from[i];
  for (int i = head; i < count; ++i) {
    const Lane further = from[i - reach];
    const Lane own = from[i];
    to[i] = (before[i] & bit) != 0 ? further : own;
  }
}
template <class Lane>
BELTPICK_INLINE void fetch_end(const Lane* __restrict from, const Lane* __restrict after, int count, int reach,
                               Lane* __restrict to) {
  const auto bit = static_cast<Lane>(reach);
  const int tail = count - without_neighbour(count, reach);
  for (int i = 0; i < tail; ++i) {
    const Lane further = from[i + reach];
    const Lane own = from[i];
    to[i] = (after[i] & bit) != 0 ? further : own;
  }
  for (int i = tail; i < count; ++i) to[i] = from[i];
}

template <class Lane>
BELTPICK_INLINE void place_within(const std::uint16_t* __restrict cell, const Lane* __restrict start,
                                  const Lane* __restrict end, const Lane* __restrict before,
                                  const Lane* __restrict after, int count, float cell_px, float* __restrict x_px) {
  for (int i = 0; i < count; ++i) {
    const float lower_px = static_cast<float>(cell[i]) * cell_px - 0.5F;
    const float upper_px = static_cast<float>(cell[i] + 1) * cell_px - 0.5F;
    const bool falls = start[i] == kFall;
    const float left_px = falls ? upper_px : lower_px;
    const float right_px = falls ? lower_px : upper_px;
    const float per_pixel = (right_px - left_px) / static_cast<float>(before[i] + after[i] + 1);
    const float within_px = left_px + (static_cast<float>(before[i]) + 0.5F) * per_pixel;
    x_px[i] = start[i] == end[i] && start[i] != kBreak ? within_px : x_px[i];
  }
}

// False where a run is longer than a lane counts.
template <class Lane>
BELTPICK_INLINE bool refine(const std::uint16_t* cell, const PixelState* state, int count, float cell_px,
                            std::uint16_t* scratch, float* x_px) {
  constexpr int kMostReach = (std::numeric_limits<Lane>::max() + 1) / 2;
  const auto row = [&](std::size_t r) {
    return reinterpret_cast<Lane*>(scratch) + r * row_numbers(count) + kRunMargin;
  };
  Lane *step = row(0), *kept = row(1);
  Lane *before = row(2), *before_next = row(3);
  Lane *after = row(4), *after_next = row(5);
  const int whole = static_cast<int>(row_numbers(count)) - 2 * kRunMargin;
  take_steps(cell, state, count, step);
  std::fill(step + count, step + whole + kRunMargin, Lane{kBreak});
  start_counts(step, whole, before, after);
  int reach = 1;
  for (bool longer = true; longer && reach < count; reach *= 2) {
    if (reach == kMostReach) return false;
    longer = double_before(before, whole, reach, before_next);
    double_after(after, whole, reach, after_next);
    std::swap(before, before_next);
    std::swap(after, after_next);
  }
  keep_like(step, before, after, whole, kept);
  kept[whole] = kBreak;
  Lane* const starts[2] = {step, kept};
  Lane* const ends[2] = {before_next, after_next};
  const Lane *start = kept, *end = kept + 1;
  int to = 0;
  for (int bit = reach / 2; bit > 0; bit /= 2, to = 1 - to) {
    fetch_start(start, before, whole, bit, starts[to]);
    fetch_end(end, after, whole, bit, ends[to]);
    start = starts[to];
    end = ends[to];
  }
  place_within(cell, start, end, before, after, count, cell_px, x_px);
  return true;
}

}  // namespace

BELTPICK_KERNEL
void refine_cells_row(const std::uint16_t* cell, const PixelState* state, int count, const CellRule& rule,
                      std::span<std::uint16_t> scratch, float* x_px) {
  if (refine<std::uint8_t>(cell, state, count, rule.cell_px, scratch.data(), x_px)) return;
  refine<std::uint16_t>(cell, state, count, rule.cell_px, scratch.data(), x_px);
}

}  // namespace beltpick::decode
