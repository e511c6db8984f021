#include "calibrate/corner_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/units.hpp"

namespace beltpick::calibrate {
namespace {

// x, y of the corner; directions of the edges' normals; blur; a, b; slope of the light.
constexpr int kX = 0, kY = 1, kAngle1 = 2, kAngle2 = 3, kBlur = 4, kMean = 5, kContrast = 6, kSlopeX = 7, kSlopeY = 8;
constexpr int kParameters = 9;
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using Normal = Eigen::Matrix<double, kParameters, kParameters>;

constexpr double kLeastBlur_px = 0.3, kMostBlurShare = 0.6;
constexpr double kMaxShift_px = 1.5;
constexpr int kMaxSteps = 30;
constexpr double kConverged_px = 1e-4;

struct Pixel {
  double x = 0.0, y = 0.0, level = 0.0;  // from the start
};

double model(const Parameters& p, const Pixel& at) {
  const double x = at.x - p[kX];
  const double y = at.y - p[kY];
  const double first = std::erf((std::cos(p[kAngle1]) * x + std::sin(p[kAngle1]) * y) / p[kBlur]);
  const double second = std::erf((std::cos(p[kAngle2]) * x + std::sin(p[kAngle2]) * y) / p[kBlur]);
  return (p[kMean] + p[kContrast] * first * second) * (1.0 + p[kSlopeX] * at.x + p[kSlopeY] * at.y);
}

double cost_of(const Parameters& p, const std::vector<Pixel>& pixels) {
  double sum = 0.0;
  for (const Pixel& pixel : pixels) {
    const double off = pixel.level - model(p, pixel);
    sum += off * off;
  }
  return sum;
}

std::vector<Pixel> pixels_round(ImageView<const float> image, const PixelPosition& start, double radius_px) {
  std::vector<Pixel> pixels;
  const int column = static_cast<int>(std::lround(start.column_px));
  const int row = static_cast<int>(std::lround(start.row_px));
  const int reach = static_cast<int>(std::ceil(radius_px));
  for (int r = row - reach; r <= row + reach; ++r) {
    for (int c = column - reach; c <= column + reach; ++c) {
      const double x = c - start.column_px;
      const double y = r - start.row_px;
      if (!image.contains(r, c) || x * x + y * y > radius_px * radius_px) continue;
      pixels.push_back({x, y, image(r, c)});
    }
  }
  return pixels;
}

// On a circle round the corner the level goes through four edges: the second harmonic tells how the squares lie, and so
// where both normals are if the edges are square to each other.
Parameters first_guess(const std::vector<Pixel>& pixels, double radius_px) {
  double mean = 0.0, cosine = 0.0, sine = 0.0, low = 1e9, high = -1e9;
  for (const Pixel& pixel : pixels) {
    const double angle = std::atan2(pixel.y, pixel.x);
    mean += pixel.level / static_cast<double>(pixels.size());
    cosine += pixel.level * std::cos(2.0 * angle);
    sine += pixel.level * std::sin(2.0 * angle);
    low = std::min(low, pixel.level);
    high = std::max(high, pixel.level);
  }
  // Bright along `bright`: both normals 45 degrees off it make the product positive there.
  const double bright = 0.5 * std::atan2(sine, cosine);
  Parameters p = Parameters::Zero();
  p[kAngle1] = bright - kPi / 4.0;
  p[kAngle2] = bright + kPi / 4.0;
  p[kBlur] = std::min(1.2, 0.3 * radius_px);
  p[kMean] = mean;
  p[kContrast] = 0.4 * (high - low);
  return p;
}

void normal_equations(const Parameters& p, const std::vector<Pixel>& pixels, Normal& normal, Parameters& right) {
  constexpr double kStep = 1e-5;
  normal.setZero();
  right.setZero();
  for (const Pixel& pixel : pixels) {
    const double here = model(p, pixel);
    Parameters slope;
    for (int i = 0; i < kParameters; ++i) {
      Parameters moved = p;
      moved[i] += kStep;
      slope[i] = (model(moved, pixel) - here) / kStep;
    }
    normal += slope * slope.transpose();
    right += slope * (pixel.level - here);
  }
}

bool is_sound(const Parameters& p, double radius_px) {
  return p.allFinite() && p[kBlur] > 0.0 && p[kBlur] < kMostBlurShare * radius_px && p[kContrast] > 0.0 &&
         std::hypot(p[kX], p[kY]) < kMaxShift_px && std::abs(std::sin(p[kAngle1] - p[kAngle2])) > 0.2;
}

}  // namespace

std::optional<PixelPosition> fit_corner(ImageView<const float> image, const PixelPosition& start, double radius_px) {
  const std::vector<Pixel> pixels = pixels_round(image, start, radius_px);
  if (pixels.size() < 3 * kParameters) return std::nullopt;
  Parameters p = first_guess(pixels, radius_px);
  double cost = cost_of(p, pixels);
  double damping = 1e-3;
  Normal normal;
  Parameters right;
  for (int step = 0; step < kMaxSteps; ++step) {
    normal_equations(p, pixels, normal, right);
    Normal damped = normal;
    damped.diagonal() *= 1.0 + damping;
    Parameters next = p + damped.ldlt().solve(right);
    next[kBlur] = std::max(next[kBlur], kLeastBlur_px);
    const double next_cost = cost_of(next, pixels);
    if (!(next_cost < cost)) {
      if (damping > 1e6) break;
      damping *= 10.0;
      continue;
    }
    const double moved_px = std::hypot(next[kX] - p[kX], next[kY] - p[kY]);
    const double gain = (cost - next_cost) / cost;
    p = next;
    cost = next_cost;
    damping *= 0.1;
    if (moved_px < kConverged_px && gain < 1e-4) break;
  }
  if (!is_sound(p, radius_px)) return std::nullopt;
  return PixelPosition{start.column_px + p[kX], start.row_px + p[kY]};
}

}  // namespace beltpick::calibrate
