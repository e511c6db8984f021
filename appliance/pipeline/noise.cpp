#include "pipeline/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace beltpick::pipeline {
namespace {

// Medians by a histogram of fixed size.
class Histogram {
 public:
  void add(float value_mm) {
    const float bin = value_mm / kBin_mm;
    ++bins_[bin < kBins - 1 ? static_cast<std::size_t>(bin) : kBins - 1];
    ++count_;
  }
  [[nodiscard]] double median_mm() const {
    int below = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      below += bins_[bin];
      if (2 * below >= count_) return (static_cast<double>(bin) + 0.5) * kBin_mm;
    }
    return 0.0;
  }

 private:
  static constexpr float kBin_mm = 0.005F;
  static constexpr std::size_t kBins = 2000;
  std::array<int, kBins> bins_{};
  int count_ = 0;
};

// |z(c-1) - 2 z(c) + z(c+1)| of a plane has the standard deviation sqrt(6) sigma, and its median is 0.6745 of that.
constexpr float kPerSecondDifference = 1.0F / (2.449F * 0.6745F);

}  // namespace

double measurement_noise_mm(const RangeImage& range, ImageView<const std::uint16_t> labels) {
  Histogram histogram;
  for (int row = 1; row + 1 < labels.rows; row += 3) {
    for (int col = 1; col + 1 < labels.cols; col += 3) {
      if (labels(row, col) == 0 || !range.valid(row, col)) continue;
      if (!range.sigma_mm.empty()) {
        histogram.add(range.sigma_mm(row, col));
      } else if (range.valid(row, col - 1) && range.valid(row, col + 1)) {
        const float bend =
            range.point_mm(row, col - 1).z() - 2.0F * range.point_mm(row, col).z() + range.point_mm(row, col + 1).z();
        histogram.add(std::abs(bend) * kPerSecondDifference);
      }
    }
  }
  return std::max(0.02, histogram.median_mm());
}

}  // namespace beltpick::pipeline
