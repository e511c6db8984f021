#include "bench/decode/noise.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::bench {
namespace {

// Mean over the measured pixels of a square of 31 around (row, col), from summed-area tables.
class LowPass {
 public:
  LowPass(const std::vector<double>& values, const std::vector<int>& valid, int rows, int cols)
      : rows_(rows), cols_(cols), sum_(table(values)), count_(table(std::vector<double>(valid.begin(), valid.end()))) {}

  [[nodiscard]] double at(int row, int col) const { return box(sum_, row, col) / box(count_, row, col); }

 private:
  [[nodiscard]] std::vector<double> table(const std::vector<double>& values) const {
    std::vector<double> summed(static_cast<std::size_t>((rows_ + 1) * (cols_ + 1)), 0.0);
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < cols_; ++c) {
        summed[index(r + 1, c + 1)] = values[static_cast<std::size_t>(r * cols_ + c)] + summed[index(r, c + 1)] +
                                      summed[index(r + 1, c)] - summed[index(r, c)];
      }
    }
    return summed;
  }
  [[nodiscard]] std::size_t index(int row, int col) const { return static_cast<std::size_t>(row * (cols_ + 1) + col); }
  [[nodiscard]] double box(const std::vector<double>& summed, int row, int col) const {
    constexpr int kReach = 15;
    const int r0 = std::max(row - kReach, 0);
    const int r1 = std::min(row + kReach + 1, rows_);
    const int c0 = std::max(col - kReach, 0);
    const int c1 = std::min(col + kReach + 1, cols_);
    return summed[index(r1, c1)] - summed[index(r0, c1)] - summed[index(r1, c0)] + summed[index(r0, c0)];
  }

  int rows_, cols_;
  std::vector<double> sum_, count_;
};

}  // namespace

Noise judge_noise(const RangeImage& range, const std::vector<float>& truth_mm) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  std::vector<double> off(range.point_mm.size(), 0.0);
  std::vector<int> valid(range.point_mm.size(), 0);
  Noise noise;
  int seen = 0;
  double predicted = 0.0;
  for (std::size_t i = 0; i < off.size(); ++i) {
    const float truth = truth_mm[3 * i + 2];
    seen += truth > 0.0F ? 1 : 0;
    if (range.point_mm.data[i].z() == 0.0F || !(truth > 0.0F)) continue;
    const Vec3f& point = range.point_mm.data[i];
    predicted += std::pow(range.sigma_mm.data[i] * point.z() / point.norm(), 2);
    off[i] = range.point_mm.data[i].z() - truth;
    valid[i] = 1;
    ++noise.points;
    noise.wrong += std::abs(off[i]) > 1.0 ? 1 : 0;
  }
  const LowPass low_pass(off, valid, rows, cols);
  double squares = 0.0;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const auto i = static_cast<std::size_t>(r * cols + c);
      if (valid[i] != 0) squares += std::pow(off[i] - low_pass.at(r, c), 2);
    }
  }
  noise.rms_mm = std::sqrt(squares / std::max(noise.points, 1));
  noise.predicted_mm = std::sqrt(predicted / std::max(noise.points, 1));
  noise.valid_share = noise.points / static_cast<double>(std::max(seen, 1));
  return noise;
}

}  // namespace beltpick::bench
