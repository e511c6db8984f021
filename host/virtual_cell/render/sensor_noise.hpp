// SensorNoise: turns light into grey levels as a CMOS sensor does: shot noise, read noise, saturation, 8 bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.hpp"

namespace beltpick::virtual_cell {

class SensorNoise {
 public:
  SensorNoise();

  // `signal`: share of full scale per pixel, row-major, as large as `image`. The noise is Gaussian with the variance of
  // shot and read noise at each pixel's own level. It is read from a table of 2^18 normal numbers from a random place
  // for each row: what two frames draw at a pixel is independent. The same `seed` gives the same bits.
  void expose(std::span<const float> signal, std::uint64_t seed, ImageView<std::uint8_t> image) const;

  // Quantised only.
  static void expose_noise_free(std::span<const float> signal, ImageView<std::uint8_t> image);

 private:
  std::vector<float> normal_;
};

}  // namespace beltpick::virtual_cell
