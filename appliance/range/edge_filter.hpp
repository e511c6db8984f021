// EdgeFilter: drops flying pixels, which mix the light of two depths at an edge.
#pragma once

#include <array>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"

namespace beltpick::range {

// A pixel flies where, along some line through it, one neighbour is nearer and the other farther than any surface in
// view could climb within a pixel: it lies between two depths. It also flies where fewer than two of its eight
// neighbours are on its surface. A thin part is left alone: across it both neighbours are farther, along it they agree.
class EdgeFilter {
 public:
  EdgeFilter() = default;
  EdgeFilter(Arena& arena, int cols);

  // Removes flying pixels of `range` in place; `focal_px` of the camera tells the width of a pixel's footprint.
  // Returns how many.
  int apply(const RangeImage& range, float focal_px);

 private:
  void load_row(const RangeImage& range, int row, float focal_px);
  int filter_row(const RangeImage& range, int row);

  // Depth of three rows, and the greatest step to the next pixel on a surface; one pixel of margin on either side.
  std::array<std::span<float>, 3> depth_mm_;
  std::array<std::span<float>, 3> step_mm_;
};

}  // namespace beltpick::range
