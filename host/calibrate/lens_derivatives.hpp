// The image of a point in a lens, with its derivatives by the point and by the nine parameters of the lens.
#pragma once

#include <Eigen/Core>

#include "base/pose.hpp"
#include "contract/calibration.hpp"

namespace beltpick::calibrate {

inline constexpr int kLensParameters = 9;
using LensVector = Eigen::Matrix<double, kLensParameters, 1>;  // fx, fy, cx, cy, k1, k2, p1, p2, k3

LensVector vector_of(const Lens& lens);
// `like` with the parameters of `vector`.
Lens lens_of(const LensVector& vector, const Lens& like);

struct ProjectedPoint {
  Eigen::Vector2d at_px;
  Eigen::Matrix<double, 2, 3> by_point;  // px per mm, the point in the lens's frame
  Eigen::Matrix<double, 2, kLensParameters> by_lens;
};

// OpenCV's five-parameter model (contract/lens_project.hpp). The point lies in front of the lens.
ProjectedPoint project_with_derivatives(const Lens& lens, const Vec3& point_mm);

}  // namespace beltpick::calibrate
