#include "range/lens_model.hpp"

#include <Eigen/LU>

namespace beltpick::range {

Vec2 distort(const Lens& lens, const Vec2& ideal) {
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = ideal.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Eigen::Matrix2d distort_jacobian(const Lens& lens, const Vec2& ideal) {
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = ideal.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);  // d radial / d r^2
  const double mixed = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
  Eigen::Matrix2d jacobian;
  jacobian << radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed,  //
      mixed, radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  return jacobian;
}

std::optional<Vec2> undistort(const Lens& lens, const Vec2& seen, const Vec2& guess) {
  constexpr int kMaxSteps = 20;
  constexpr double kConverged = 1e-10;  // 1e-7 of a pixel at any focal length in use
  Vec2 ideal = guess;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Matrix2d jacobian = distort_jacobian(lens, ideal);
    const Vec2 off = distort(lens, ideal) - seen;
    // Beyond the radius where the model turns back, its determinant is no longer positive.
    if (!(jacobian.determinant() > 0.0)) return std::nullopt;
    if (off.squaredNorm() < kConverged * kConverged) return ideal;
    ideal -= jacobian.inverse() * off;
  }
  return std::nullopt;
}

}  // namespace beltpick::range
