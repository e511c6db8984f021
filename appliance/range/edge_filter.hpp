// EdgeFilter: finds flying pixels, which mix the light of two depths at an edge, while the rows of a range image come
// by.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/arena.hpp"

namespace beltpick::range {

// A pixel flies where
//   - along some line through it one neighbour is nearer and the other farther than any surface in view could climb
//     within a pixel: it lies between two depths; or
//   - fewer than two of its eight neighbours are on its surface; or
//   - it is the last one of its surface along some line and has less than half the modulation of the one before: the
//     edge runs through it, and what its centre sees is not the surface that was measured.
// A thin part is left alone: across it both neighbours are farther, along it they agree.
//
// Streams, so that a row is judged while it lies in the cache: push() takes row after row and gives the verdict on the
// row before, last() the verdict on the last one.
class EdgeFilter {
 public:
  EdgeFilter() = default;
  EdgeFilter(Arena& arena, int cols);

  // Starts an image of `cols` columns; `focal_px` of the camera tells the width of a pixel's footprint.
  void begin(int cols, float focal_px);

  // The next row: camera z (0: not measured), its standard deviation, and modulation, `cols` values each. Returns one
  // byte a pixel of the row before, 1 where it flies (never where nothing was measured); good until the next call.
  // After the first row there is none to judge: an empty span.
  std::span<const std::uint8_t> push(const float* depth_mm, const float* sigma_mm, const float* modulation);
  // The verdict on the row pushed last.
  std::span<const std::uint8_t> last();

 private:
  // Depth and modulation of three rows, with a pixel of margin on either side, and the greatest step from a pixel to
  // the next on one surface.
  struct Row {
    std::span<float> depth_mm, modulation, step_mm;
    std::span<std::uint8_t> rough;  // by block of columns: what the depths do along the row and to the row above
  };

  Row& row_at(int row) { return rows_[static_cast<std::size_t>(row + 3) % 3]; }
  std::span<const std::uint8_t> judge(int row);

  std::array<Row, 3> rows_;
  std::span<std::uint8_t> flies_;
  int cols_ = 0;
  float steepest_ = 0.0F;  // step over depth of the steepest surface
  int pushed_ = 0;
};

}  // namespace beltpick::range
