#include "virtual_cell/render/camera_blur.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/kernel.hpp"

namespace beltpick::virtual_cell {
namespace {

// out[i] = sum over k of weight[|k|] * in[i + k * stride].
BELTPICK_KERNEL void blur_line(const float* in, int stride, const float* weight, int taps, int count, float* out) {
  for (int i = 0; i < count; ++i) out[i] = weight[0] * in[i];
  for (int k = 1; k < taps; ++k) {
    const float* before = in - k * stride;
    const float* after = in + k * stride;
    for (int i = 0; i < count; ++i) out[i] += weight[k] * (before[i] + after[i]);
  }
}

}  // namespace

CameraBlur::CameraBlur(double sigma_px) {
  if (sigma_px <= 0.0) return;
  std::vector<double> weight;
  double sum = 1.0;
  if (sigma_px < 0.6) {
    // Samples of so narrow a Gaussian miss its variance; three taps that have it do not.
    weight = {1.0 - sigma_px * sigma_px, 0.5 * sigma_px * sigma_px};
  } else {
    const int reach = static_cast<int>(std::ceil(3.5 * sigma_px));
    for (int k = 0; k <= reach; ++k) weight.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
    sum = 2.0 * std::accumulate(weight.begin() + 1, weight.end(), 0.0) + weight[0];
  }
  for (const double w : weight) half_.push_back(static_cast<float>(w / sum));
}

void CameraBlur::apply(std::vector<float>& signal, int rows, int cols) {
  if (half_.empty()) return;
  const int taps = static_cast<int>(half_.size());
  const int reach = taps - 1;
  // Across into lines with room above and below, then down.
  across_.resize(static_cast<std::size_t>(rows + 2 * reach) * cols);
  padded_.resize(static_cast<std::size_t>(cols + 2 * reach));
  for (int row = 0; row < rows; ++row) {
    const float* from = signal.data() + static_cast<std::size_t>(row) * cols;
    std::fill_n(padded_.begin(), reach, from[0]);
    std::copy_n(from, cols, padded_.begin() + reach);
    std::fill_n(padded_.begin() + reach + cols, reach, from[cols - 1]);
    blur_line(padded_.data() + reach, 1, half_.data(), taps, cols,
              across_.data() + static_cast<std::size_t>(row + reach) * cols);
  }
  for (int k = 0; k < reach; ++k) {
    std::copy_n(across_.begin() + static_cast<std::ptrdiff_t>(reach) * cols, cols,
                across_.begin() + static_cast<std::ptrdiff_t>(k) * cols);
    std::copy_n(across_.begin() + static_cast<std::ptrdiff_t>(reach + rows - 1) * cols, cols,
                across_.begin() + static_cast<std::ptrdiff_t>(reach + rows + k) * cols);
  }
  for (int row = 0; row < rows; ++row) {
    blur_line(across_.data() + static_cast<std::size_t>(row + reach) * cols, cols, half_.data(), taps, cols,
              signal.data() + static_cast<std::size_t>(row) * cols);
  }
}

}  // namespace beltpick::virtual_cell
