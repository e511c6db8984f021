#include "decode/gray_subpixel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace beltpick::decode {
namespace {

constexpr int kLikeLength = 3;  // times longer or shorter, and two pixels, at most

// The pixels from first to before end have one cell; none where first == end.
struct Run {
  int first = 0, end = 0;
  int cell = 0;

  [[nodiscard]] int length() const { return end - first; }
};

Run run_from(const std::uint16_t* cell, const PixelState* state, int first, int count) {
  Run run{first, first, first < count ? cell[first] : 0};
  while (run.end < count && state[run.end] == PixelState::kValid && cell[run.end] == run.cell) ++run.end;
  return run;
}

// Whether `next` begins where `run` ends, on the same surface.
bool goes_on(const Run& run, const Run& next) {
  const int shorter = std::min(run.length(), next.length());
  const int longer = std::max(run.length(), next.length());
  return shorter > 0 && next.first == run.end && std::abs(next.cell - run.cell) == 1 &&
         longer <= kLikeLength * shorter + 2;
}

// The border between two neighbouring cells.
float border_px(const Run& a, const Run& b, const CellRule& rule) {
  return static_cast<float>(std::max(a.cell, b.cell)) * rule.cell_px - 0.5F;
}

}  // namespace

void refine_cells_row(const std::uint16_t* cell, const PixelState* state, int count, const CellRule& rule,
                      float* x_px) {
  Run before;
  Run run = run_from(cell, state, 0, count);
  while (run.first < count) {
    const int next_first = run.length() > 0 ? run.end : run.first + 1;
    const Run next = run_from(cell, state, next_first, count);
    if (goes_on(before, run) && goes_on(run, next) && before.cell != next.cell) {
      const float left_px = border_px(before, run, rule);
      const float per_pixel = (border_px(run, next, rule) - left_px) / static_cast<float>(run.length());
      for (int i = run.first; i < run.end; ++i)
        x_px[i] = left_px + (static_cast<float>(i - run.first) + 0.5F) * per_pixel;
    }
    before = run;
    run = next;
  }
}

}  // namespace beltpick::decode
