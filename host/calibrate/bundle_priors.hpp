// What is known before any capture, as further residuals of the joint refinement: so weak that good captures overrule
// it, and enough that few captures do not run away.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "calibrate/lens_derivatives.hpp"
#include "calibrate/observations.hpp"

namespace beltpick::calibrate {

// What priors speak of, numbered through: camera, projector, 6 unused places of the stereo pose, heights by corner.
struct PriorValues {
  LensVector camera, projector;
  const std::vector<double>& height_mm;

  [[nodiscard]] double operator[](int parameter) const {
    if (parameter < kLensParameters) return camera[parameter];
    if (parameter < 2 * kLensParameters) return projector[parameter - kLensParameters];
    return height_mm[static_cast<std::size_t>(parameter - 2 * kLensParameters - 6)];
  }
};

// residual = sum of weight * parameter - expected, in standard deviations.
struct Prior {
  std::vector<std::pair<int, double>> terms;  // parameter, weight
  double expected = 0.0;

  [[nodiscard]] double residual(const PriorValues& values) const {
    double sum = -expected;
    for (const auto& [parameter, weight] : terms) sum += weight * values[parameter];
    return sum;
  }
};

// Principal points near the images' middle, and distortion that at the outermost corner seen is small.
std::vector<Prior> rig_priors(const Observations& seen, const Calibration& start);

// A plate that bends smoothly; its mean height and tilt, which its poses hold already, are zero.
void add_shape_priors(const Board& board, std::vector<Prior>& priors);

}  // namespace beltpick::calibrate
