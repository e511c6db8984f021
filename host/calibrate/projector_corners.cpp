#include "calibrate/projector_corners.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/camera_noise.hpp"

namespace beltpick::calibrate {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kWindowShare = 0.6;  // of the spacing: up to well inside all four squares
constexpr double kMinWindow_px = 5.0, kMaxWindow_px = 32.0;
constexpr double kEdgeSlope = 0.04;  // of the local contrast, a pixel: steeper is the edge of a print
constexpr int kLeastPixels = 24;
constexpr int kLeastHalf = 6;  // pixels to each side of the corner, whichever way one looks: it lies amidst them
constexpr double kTukey = 4.0;
constexpr int kRounds = 6;

struct Sample {
  Vector6 basis;  // 1, x, y, x^2, xy, y^2 in windows
  double value_px = 0.0;
  double sigma_px = 0.0;
};

struct Fit {
  double value_px = 0.0;
  double by_column = 0.0, by_row = 0.0;
  double sigma_px = 0.0;
};

struct Window {
  double column = 0.0, row = 0.0, half_px = 0.0;
  int row_from = 0, row_to = 0, column_from = 0, column_to = 0;  // inclusive, one pixel inside the image
};

Window window_at(const ObservedCorner& corner, double spacing_px, int rows, int cols) {
  Window window{corner.camera_px.column_px, corner.camera_px.row_px,
                std::clamp(kWindowShare * spacing_px, kMinWindow_px, kMaxWindow_px)};
  window.row_from = std::max(1, static_cast<int>(std::ceil(window.row - window.half_px)));
  window.row_to = std::min(rows - 2, static_cast<int>(std::floor(window.row + window.half_px)));
  window.column_from = std::max(1, static_cast<int>(std::ceil(window.column - window.half_px)));
  window.column_to = std::min(cols - 2, static_cast<int>(std::floor(window.column + window.half_px)));
  return window;
}

template <class Visit>
void for_pixels(const Window& window, Visit visit) {
  for (int row = window.row_from; row <= window.row_to; ++row) {
    for (int col = window.column_from; col <= window.column_to; ++col) visit(row, col);
  }
}

// Brightest less darkest level of the window, but for a twentieth at each end.
double contrast_of(ImageView<const float> flat, const Window& window) {
  std::vector<float> levels;
  for_pixels(window, [&](int row, int col) { levels.push_back(flat(row, col)); });
  if (levels.empty()) return 0.0;
  std::sort(levels.begin(), levels.end());
  return levels[levels.size() * 19 / 20] - levels[levels.size() / 20];
}

bool on_print_edge(ImageView<const float> flat, int row, int col, double steep) {
  const double by_column = 0.5 * (flat(row, col + 1) - flat(row, col - 1));
  const double by_row = 0.5 * (flat(row + 1, col) - flat(row - 1, col));
  return std::hypot(by_column, by_row) > steep;
}

double code_sigma_px(const CodeNoise& noise, float modulation, float level) {
  const double grey = std::sqrt(static_cast<double>(kCameraNoise.variance(level)));
  return std::hypot(static_cast<double>(noise.floor_px), noise.slope_px * grey / std::max(modulation, 1.0F));
}

std::vector<Sample> samples_in(const CodeImage& code, Axis axis, ImageView<const float> flat, const Window& window,
                               double steep) {
  const bool column = axis == Axis::kColumn;
  const ImageView<float>& values = column ? code.column_px : code.row_px;
  std::vector<Sample> samples;
  std::array<int, 8> halves{};
  for_pixels(window, [&](int row, int col) {
    const float value = values(row, col);
    if (std::isnan(value) || on_print_edge(flat, row, col, steep)) return;
    const double x = (col - window.column) / window.half_px;
    const double y = (row - window.row) / window.half_px;
    Sample sample;
    sample.basis << 1.0, x, y, x * x, x * y, y * y;
    sample.value_px = value;
    sample.sigma_px =
        code_sigma_px(column ? code.column_noise : code.row_noise, code.modulation(row, col), flat(row, col));
    samples.push_back(sample);
    const double ahead[] = {x, y, x + y, x - y};
    for (std::size_t half = 0; half < 4; ++half) ++halves[2 * half + (ahead[half] > 0.0 ? 1U : 0U)];
  });
  const bool all_round = std::all_of(halves.begin(), halves.end(), [](int n) { return n >= kLeastHalf; });
  if (samples.size() < kLeastPixels || !all_round) samples.clear();
  return samples;
}

// Median of |residual| / sigma over that of a normal distribution.
double spread_of(const std::vector<Sample>& samples, const Vector6& fit) {
  std::vector<double> sizes;
  for (const Sample& sample : samples) {
    sizes.push_back(std::abs(sample.value_px - sample.basis.dot(fit)) / sample.sigma_px);
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return std::max(*middle / 0.6745, 1e-3);
}

std::optional<Fit> fit_samples(const std::vector<Sample>& samples, double half_px) {
  Vector6 fit = Vector6::Zero();
  Matrix6 normal = Matrix6::Zero();
  double spread = 0.0;  // the first round takes all
  for (int round = 0; round < kRounds; ++round) {
    normal.setZero();
    Vector6 right = Vector6::Zero();
    int used = 0;
    for (const Sample& sample : samples) {
      double weight = 1.0 / (sample.sigma_px * sample.sigma_px);
      if (round > 0) {
        const double off = (sample.value_px - sample.basis.dot(fit)) / (kTukey * spread * sample.sigma_px);
        if (std::abs(off) >= 1.0) continue;
        weight *= (1.0 - off * off) * (1.0 - off * off);
      }
      normal += weight * sample.basis * sample.basis.transpose();
      right += weight * sample.value_px * sample.basis;
      ++used;
    }
    if (used < kLeastPixels) return std::nullopt;
    fit = normal.ldlt().solve(right);
    spread = spread_of(samples, fit);
  }
  const double variance = normal.ldlt().solve(Vector6::Unit(0))[0];
  if (!fit.allFinite() || !(variance > 0.0)) return std::nullopt;
  return Fit{fit[0], fit[1] / half_px, fit[2] / half_px, std::sqrt(variance) * std::max(spread, 1.0)};
}

}  // namespace

void fit_projector_corner(const CodeImage& code, ImageView<const float> flat, double spacing_px,
                          ObservedCorner& corner) {
  const Window window = window_at(corner, spacing_px, flat.rows, flat.cols);
  const double steep = kEdgeSlope * contrast_of(flat, window);
  std::optional<Fit> fits[2];
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    const auto samples = samples_in(code, axis, flat, window, steep);
    if (!samples.empty()) fits[static_cast<std::size_t>(axis)] = fit_samples(samples, window.half_px);
  }
  if (!fits[0] || !fits[1]) {
    corner.no_projector_reason = "too few pixels round it have a projector coordinate";
    return;
  }
  corner.projector_px = {fits[0]->value_px, fits[1]->value_px};
  corner.projector_by_camera << fits[0]->by_column, fits[0]->by_row, fits[1]->by_column, fits[1]->by_row;
  corner.projector_sigma_px = std::max(fits[0]->sigma_px, fits[1]->sigma_px);
}

}  // namespace beltpick::calibrate
