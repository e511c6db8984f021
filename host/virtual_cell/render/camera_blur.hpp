// CameraBlur: the point spread of the camera's lens over its pixels.
#pragma once

#include <vector>

namespace beltpick::virtual_cell {

class CameraBlur {
 public:
  // A Gaussian of `sigma_px`; nothing where it is 0.
  explicit CameraBlur(double sigma_px);
  // Blurs rows x cols values; beyond the border stands what stands at it.
  void apply(std::vector<float>& signal, int rows, int cols);

 private:
  std::vector<float> half_;  // weights of the middle and of the taps on one side
  std::vector<float> padded_, across_;
};

}  // namespace beltpick::virtual_cell
