// FlatImage: the scene as under even light, made of all frames whose patterns add up to it, so that its noise is far
// below that of one frame and no fringe is left in it. Corners are looked for in it.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.hpp"
#include "contract/capture.hpp"

namespace beltpick::calibrate {

class FlatImage {
 public:
  FlatImage(const Sequence& sequence, int rows, int cols, int full_scale);

  // Adds frame `index` of the sequence, in any order.
  void add(int index, ImageView<const std::uint8_t> image) { add_any(index, image); }
  void add(int index, ImageView<const std::uint16_t> image) { add_any(index, image); }

  // The mean of the best exposure's frames, 0..255: the longest in which next to nothing is saturated. A view of this
  // object's memory.
  [[nodiscard]] ImageView<const float> finish();

 private:
  struct Exposure {
    double exposure_us = 0.0;
    int frames = 0;
    std::int64_t saturated = 0;  // pixels, over all frames
    std::vector<float> sum;
  };

  template <class Pixel>
  void add_any(int index, ImageView<const Pixel> image);

  int rows_, cols_, full_scale_;
  std::vector<int> exposure_of_;  // by frame; -1: the frame takes no part
  std::vector<Exposure> exposures_;
};

}  // namespace beltpick::calibrate
