#include "segment/roster.hpp"

#include <algorithm>
#include <functional>

#include "base/each_set.hpp"

namespace beltpick::segment {

namespace {
constexpr std::size_t kNumbers = 65536;
}

Roster::Roster(Arena& arena, int max_segments)
    : segments_(arena.take<Segment>("segment: labels", static_cast<std::size_t>(max_segments))),
      pixels_(arena.take<std::int32_t>("segment: labels", kNumbers)),
      sorted_(arena.take<std::int32_t>("segment: labels", kNumbers)),
      label_of_number_(arena.take<std::uint16_t>("segment: labels", kNumbers)) {}

// Numbers that stay get labels in raster order of their first pixel.
void Roster::choose(std::span<const std::uint16_t> numbers, int& total) {
  std::fill(pixels_.begin(), pixels_.end(), 0);
  std::fill(label_of_number_.begin(), label_of_number_.end(), std::uint16_t{0});
  each_set(numbers, [&](std::size_t p) { ++pixels_[numbers[p]]; });
  total = static_cast<int>(std::count_if(pixels_.begin(), pixels_.end(), [](std::int32_t n) { return n > 0; }));
  std::int32_t least = 1;
  if (static_cast<std::size_t>(total) > segments_.size()) {
    std::copy(pixels_.begin(), pixels_.end(), sorted_.begin());
    const auto last = sorted_.begin() + static_cast<std::ptrdiff_t>(segments_.size()) - 1;
    std::nth_element(sorted_.begin(), last, sorted_.end(), std::greater<>());
    least = *last;
  }
  count_ = 0;
  each_set(numbers, [&](std::size_t p) {
    const std::uint16_t number = numbers[p];
    if (label_of_number_[number] != 0 || pixels_[number] < least || count_ == segments_.size()) return;
    label_of_number_[number] = static_cast<std::uint16_t>(++count_);
  });
}

void Roster::measure(const RangeImage& range, std::span<const float> height_mm, std::span<const std::uint16_t> labels) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  for (std::size_t i = 0; i < count_; ++i) {
    segments_[i] = {.label = static_cast<std::uint16_t>(i + 1),
                    .row_min = rows,
                    .row_max = -1,
                    .col_min = cols,
                    .col_max = -1,
                    .pixels = 0,
                    .top_mm = -1e9F,
                    .touches_border = false};
  }
  for (int row = 0; row < rows; ++row) {
    const auto in_row = labels.subspan(static_cast<std::size_t>(row * cols), static_cast<std::size_t>(cols));
    each_set(in_row, [&](std::size_t at) {
      const int col = static_cast<int>(at);
      const int here = row * cols + col;
      Segment& segment = segments_[labels[here] - 1];
      segment.row_min = std::min(segment.row_min, row);
      segment.row_max = std::max(segment.row_max, row);
      segment.col_min = std::min(segment.col_min, col);
      segment.col_max = std::max(segment.col_max, col);
      ++segment.pixels;
      // A single pixel that sticks out is noise: its neighbour must be as high.
      if (col + 1 < cols && labels[here + 1] == labels[here]) {
        segment.top_mm = std::max(segment.top_mm, std::min(height_mm[here], height_mm[here + 1]));
      }
    });
  }
  for (Segment& segment : segments_.first(count_)) {
    segment.touches_border =
        segment.row_min <= 1 || segment.col_min <= 1 || segment.row_max >= rows - 2 || segment.col_max >= cols - 2;
  }
}

int Roster::list(const RangeImage& range, std::span<const std::uint16_t> numbers, std::span<const float> height_mm,
                 std::span<std::uint16_t> labels) {
  int total = 0;
  choose(numbers, total);
  std::fill_n(labels.begin(), numbers.size(), std::uint16_t{0});
  each_set(numbers, [&](std::size_t p) { labels[p] = label_of_number_[numbers[p]]; });
  measure(range, height_mm, labels.first(numbers.size()));
  return total;
}

}  // namespace beltpick::segment
