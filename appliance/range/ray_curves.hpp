// RayCurves: the rays of a camera's pixels, as curves from block to block of a row. Internal to range.
//
// A lens bends the grid of pixels so gently that a parabola through the rays at the corners of a block gives those
// between to less than a thousandth of a pixel, in less time than it takes to read them from memory.
#pragma once

#include <array>
#include <span>

#include "base/arena.hpp"
#include "contract/calibration.hpp"
#include "range/point_kernel.hpp"

namespace beltpick::range {

class RayCurves {
 public:
  // Room for cameras of up to rows x cols.
  RayCurves(Arena& arena, int rows, int cols);

  // False where the lens has no ray for some pixel.
  bool load(const Lens& camera);

  // Good until the next call.
  RayRow row(int row);

 private:
  struct Coordinate {
    std::span<float> corners;  // by image row
    std::span<float> slope, bend;
  };
  std::array<Coordinate, 2> coordinates_;  // u, v
  int across_ = 0;                         // corners
};

}  // namespace beltpick::range
