#include "segment/components.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "base/each_set.hpp"

namespace beltpick::segment {

namespace {
// Right, down and the diagonals below: each pair of neighbours once.
constexpr std::array<std::array<int, 2>, 4> kNeighbours{{{0, 1}, {1, 0}, {1, 1}, {1, -1}}};
}  // namespace

Components::Components(Arena& arena, int max_pixels)
    : parent_(arena.take_scratch<std::int32_t>(Phase::kLocate, "segment: components",
                                               static_cast<std::size_t>(max_pixels))),
      size_(arena.take_scratch<std::int32_t>(Phase::kLocate, "segment: components",
                                             static_cast<std::size_t>(max_pixels))),
      numbers_(arena.take_scratch<std::uint16_t>(Phase::kLocate, "segment: components",
                                                 static_cast<std::size_t>(max_pixels))) {}

std::int32_t Components::root(std::int32_t pixel) {
  while (parent_[pixel] != pixel) {
    parent_[pixel] = parent_[parent_[pixel]];  // halve the path for those who come after
    pixel = parent_[pixel];
  }
  return pixel;
}

void Components::unite(std::int32_t a, std::int32_t b) {
  a = root(a);
  b = root(b);
  // The smaller pixel stays the root: so a component is known by its first pixel in raster order.
  if (a < b) parent_[b] = a;
  if (b < a) parent_[a] = b;
}

int Components::find(const RangeImage& range, std::span<const std::uint8_t> mask, const Scale& scale, int min_pixels) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  const auto pixels = static_cast<std::int32_t>(range.point_mm.size());
  const auto in_mask = mask.first(range.point_mm.size());
  std::fill_n(parent_.begin(), pixels, -1);
  each_set(in_mask, [&](std::size_t p) {
    parent_[p] = static_cast<std::int32_t>(p);
    size_[p] = 0;
  });
  for (int row = 0; row < rows; ++row) {
    each_set(in_mask.subspan(static_cast<std::size_t>(row * cols), static_cast<std::size_t>(cols)),
             [&](std::size_t at) {
               const int col = static_cast<int>(at);
               const std::int32_t here = row * cols + col;
               for (const auto& [down, right] : kNeighbours) {
                 if (row + down >= rows || col + right >= cols || col + right < 0) continue;
                 const std::int32_t there = here + down * cols + right;
                 // Most neighbours hang together by way of others already.
                 if (parent_[there] < 0 || parent_[there] == parent_[here]) continue;
                 if (linked(range.point_mm(row, col), range.point_mm(row + down, col + right), scale))
                   unite(here, there);
               }
             });
  }
  each_set(in_mask, [&](std::size_t p) { ++size_[root(static_cast<std::int32_t>(p))]; });
  int count = 0;
  std::fill_n(numbers_.begin(), pixels, std::uint16_t{0});
  each_set(in_mask, [&](std::size_t at) {
    const auto p = static_cast<std::int32_t>(at);
    if (parent_[p] == p) {
      const bool kept = size_[p] >= min_pixels && count < std::numeric_limits<std::uint16_t>::max() - 1;
      numbers_[p] = kept ? static_cast<std::uint16_t>(++count) : std::uint16_t{0};
    } else {
      numbers_[p] = numbers_[root(p)];  // the root came earlier
    }
  });
  return count;
}

}  // namespace beltpick::segment
