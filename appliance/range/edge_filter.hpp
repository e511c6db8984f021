// EdgeFilter: drops flying pixels, which mix the light of two depths at an edge.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"

namespace beltpick::range {

// A pixel flies where
//   - along some line through it one neighbour is nearer and the other farther than any surface in view could climb
//     within a pixel: it lies between two depths; or
//   - fewer than two of its eight neighbours are on its surface; or
//   - it is the last one of its surface along some line and has less than half the modulation of the one before: the
//     edge runs through it, and what its centre sees is not the surface that was measured.
// A thin part is left alone: across it both neighbours are farther, along it they agree.
class EdgeFilter {
 public:
  EdgeFilter() = default;
  EdgeFilter(Arena& arena, int cols);

  // Removes flying pixels of `range` in place; `focal_px` of the camera tells the width of a pixel's footprint.
  // Returns how many.
  int apply(const RangeImage& range, ImageView<const float> modulation, float focal_px);

 private:
  // Three rows of depth and modulation, with a pixel of margin on either side, and the greatest step from a pixel to
  // the next on one surface.
  struct Row {
    std::span<float> depth_mm, modulation, step_mm;
  };

  Row& row_at(int row) { return rows_[static_cast<std::size_t>(row + 3) % 3]; }
  void load_row(const RangeImage& range, ImageView<const float> modulation, int row, float focal_px);

  std::array<Row, 3> rows_;
  std::span<std::uint8_t> flies_;
};

}  // namespace beltpick::range
