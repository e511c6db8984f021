// OpenCV's lens model in normalised coordinates (x / z, y / z): distortion and its inverse.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "contract/calibration.hpp"

namespace beltpick::range {

using Vec2 = Eigen::Vector2d;

// x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), y_d alike with p1 and p2 swapped.
Vec2 distort(const Lens& lens, const Vec2& ideal);
// d distort / d ideal.
Eigen::Matrix2d distort_jacobian(const Lens& lens, const Vec2& ideal);

// The ideal coordinates that distort to `seen`, by Newton's method from `guess`; nothing where the model folds over
// and none exists.
std::optional<Vec2> undistort(const Lens& lens, const Vec2& seen, const Vec2& guess);

}  // namespace beltpick::range
