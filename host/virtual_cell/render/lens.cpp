// OpenCV's documented forward model; its inverse is found numerically.
#include "virtual_cell/render/lens.hpp"

#include <Eigen/LU>

namespace beltpick::virtual_cell {

Eigen::Vector2d RichLens::distort(const Eigen::Vector2d& ideal) const {
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = x * x + y * y;
  const double r4 = r2 * r2;
  const double radial = (1.0 + k[0] * r2 + k[1] * r4 + k[2] * r4 * r2) / (1.0 + k[3] * r2 + k[4] * r4 + k[5] * r4 * r2);
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + s[0] * r2 + s[1] * r4,
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + s[2] * r2 + s[3] * r4};
}

Eigen::Vector2d RichLens::undistort(const Eigen::Vector2d& distorted) const {
  constexpr double kStep = 1e-6;
  Eigen::Vector2d guess = distorted;
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Eigen::Vector2d error = distort(guess) - distorted;
    if (error.squaredNorm() < 1e-26) break;
    Eigen::Matrix2d jacobian;
    jacobian.col(0) = (distort(guess + Eigen::Vector2d(kStep, 0.0)) - distort(guess - Eigen::Vector2d(kStep, 0.0)));
    jacobian.col(1) = (distort(guess + Eigen::Vector2d(0.0, kStep)) - distort(guess - Eigen::Vector2d(0.0, kStep)));
    guess -= (jacobian / (2.0 * kStep)).inverse() * error;
  }
  return guess;
}

Eigen::Vector2d RichLens::project(const Vec3& point_mm) const {
  const Eigen::Vector2d distorted = distort(point_mm.head<2>() / point_mm.z());
  return {fx_px * distorted.x() + cx_px, fy_px * distorted.y() + cy_px};
}

Vec3 RichLens::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d ideal = undistort({(pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px});
  return {ideal.x(), ideal.y(), 1.0};
}

}  // namespace beltpick::virtual_cell
