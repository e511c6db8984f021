#include "segment/scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace beltpick::segment {

namespace {

constexpr int kLattice = 20000;
constexpr std::size_t kLeast = 50;
// A predicted sigma beyond this multiple of the typical one: shadow edges, glare.
constexpr double kPoor = 6.0;

// A sample of fixed size of which the median is wanted.
class Sample {
 public:
  void add(double value) {
    if (count_ < values_.size()) values_[count_++] = static_cast<float>(value);
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  double median() {
    const auto middle = values_.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
    std::nth_element(values_.begin(), middle, values_.begin() + static_cast<std::ptrdiff_t>(count_));
    return *middle;
  }
  // Root mean square of what lies within three times itself, from `start` on: steps and edges fall away. Quantised
  // depth gives so many zeros that a median would tell nothing.
  [[nodiscard]] double trimmed_rms(double start) const {
    double rms = start;
    for (int round = 0; round < 6; ++round) {
      double sum = 0.0;
      int used = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        const double value = static_cast<double>(values_[i]);
        if (value > 3.0 * rms) continue;
        sum += value * value;
        ++used;
      }
      if (used == 0) return rms;
      rms = std::sqrt(sum / used);
    }
    return rms;
  }

 private:
  std::array<float, kLattice> values_{};
  std::size_t count_ = 0;
};

// The second difference over pixels 2 apart: zero on a plane, independent of its lean. Negative: not to be had.
double second_difference_mm(const RangeImage& range, int row, int col) {
  if (col < 2 || col + 2 >= range.point_mm.cols) return -1.0;
  for (const int c : {col - 2, col, col + 2}) {
    if (!range.valid(row, c)) return -1.0;
  }
  return std::abs(range.point_mm(row, col - 2).z() - 2.0F * range.point_mm(row, col).z() +
                  range.point_mm(row, col + 2).z());
}

}  // namespace

Scale measure_scale(const RangeImage& range) {
  Sample pitch;
  Sample bend;
  Sample depth;
  Sample predicted;
  const int stride =
      std::max(1, static_cast<int>(std::sqrt(static_cast<double>(range.point_mm.size()) / kLattice)) + 1);
  for (int row = 0; row < range.point_mm.rows; row += stride) {
    for (int col = 0; col + 1 < range.point_mm.cols; col += stride) {
      if (!range.valid(row, col) || !range.valid(row, col + 1)) continue;
      const Vec3f& here = range.point_mm(row, col);
      const Vec3f& right = range.point_mm(row, col + 1);
      pitch.add(std::hypot(right.x() / right.z() - here.x() / here.z(), right.y() / right.z() - here.y() / here.z()));
      depth.add(here.z());
      if (!range.sigma_mm.empty()) predicted.add(range.sigma_mm(row, col));
      const double second_mm = second_difference_mm(range, row, col);
      if (second_mm >= 0.0) bend.add(second_mm);
    }
  }
  Scale scale;
  if (pitch.count() < kLeast) return scale;
  scale.pitch_rad = pitch.median();
  scale.noise_z_mm = depth.median();
  if (predicted.count() > 0) scale.poor_sigma_mm = kPoor * predicted.median();
  if (bend.count() >= kLeast) {
    const double start_mm = 4.0 * scale.pitch_mm(scale.noise_z_mm);
    scale.noise_mm = bend.trimmed_rms(start_mm) / std::sqrt(6.0);  // z - 2 z + z has six variances
  }
  return scale;
}

}  // namespace beltpick::segment
