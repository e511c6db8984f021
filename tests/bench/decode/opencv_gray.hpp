// OpenCV's own decoder of Gray codes (structured_light, of its contributed modules) on a capture of both axes with
// inverted twins.
#pragma once

#include "bench/decode/job.hpp"

namespace beltpick::bench {

struct GrayTimes {
  double opencv_ms = 0.0;
  int compared = 0;   // pixels that both decoded
  int different = 0;  // of them, by more than the half pixel that a cell's centre is off its number
};

// Decodes every pixel with GrayCodePattern::getProjPixel and compares with `reference`. The capture's frames must be in
// OpenCV's order: columns from the highest bit, each followed by its inverse, then rows, then white and black.
GrayTimes time_opencv_gray(const Loaded& loaded, const Job& reference, int passes);

}  // namespace beltpick::bench
