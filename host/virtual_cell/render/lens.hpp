// RichLens: the true lens of the virtual cell: OpenCV's rational model with thin prism terms, richer than the five
// parameters that a calibration fits.
#pragma once

#include <array>

#include <Eigen/Core>

#include "base/pose.hpp"

namespace beltpick::virtual_cell {

// OpenCV's names and order of meaning: radial (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6), tangential
// p1, p2, thin prism s1..s4. Pixel centres lie at integers.
struct RichLens {
  int width = 0, height = 0;
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  std::array<double, 6> k{};
  double p1 = 0.0, p2 = 0.0;
  std::array<double, 4> s{};

  // Normalised image coordinates (x/z, y/z) to the distorted ones.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& ideal) const;
  // The inverse, by Newton's method; exact to 1e-12 within the image.
  [[nodiscard]] Eigen::Vector2d undistort(const Eigen::Vector2d& distorted) const;

  // A point of the lens's own frame (mm, z > 0) to its pixel.
  [[nodiscard]] Eigen::Vector2d project(const Vec3& point_mm) const;
  // The direction seen at a pixel, with z = 1.
  [[nodiscard]] Vec3 ray(const Eigen::Vector2d& pixel) const;
};

}  // namespace beltpick::virtual_cell
