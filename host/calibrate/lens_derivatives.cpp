#include "calibrate/lens_derivatives.hpp"

namespace beltpick::calibrate {

LensVector vector_of(const Lens& lens) {
  LensVector vector;
  vector << lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px,
      Eigen::Map<const Eigen::Matrix<double, 5, 1>>(lens.distortion.data());
  return vector;
}

Lens lens_of(const LensVector& vector, const Lens& like) {
  return {like.width,
          like.height,
          vector[0],
          vector[1],
          vector[2],
          vector[3],
          {vector[4], vector[5], vector[6], vector[7], vector[8]}};
}

ProjectedPoint project_with_derivatives(const Lens& lens, const Vec3& point_mm) {
  const double inverse_z = 1.0 / point_mm.z();
  const double x = point_mm.x() * inverse_z;
  const double y = point_mm.y() * inverse_z;
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double radial_by_r2 = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
  const double xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;

  Eigen::Matrix2d bend;  // d (xd, yd) / d (x, y)
  bend(0, 0) = radial + 2.0 * x * x * radial_by_r2 + 2.0 * p1 * y + 6.0 * p2 * x;
  bend(0, 1) = 2.0 * x * y * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y;
  bend(1, 0) = bend(0, 1);
  bend(1, 1) = radial + 2.0 * y * y * radial_by_r2 + 6.0 * p1 * y + 2.0 * p2 * x;
  Eigen::Matrix<double, 2, 3> ideal;  // d (x, y) / d point
  ideal << inverse_z, 0.0, -x * inverse_z, 0.0, inverse_z, -y * inverse_z;

  ProjectedPoint result;
  const Eigen::Vector2d focal(lens.fx_px, lens.fy_px);
  result.at_px = {lens.fx_px * xd + lens.cx_px, lens.fy_px * yd + lens.cy_px};
  result.by_point = focal.asDiagonal() * (bend * ideal);
  result.by_lens.row(0) << xd, 0.0, 1.0, 0.0, lens.fx_px * x * r2, lens.fx_px * x * r2 * r2, lens.fx_px * 2.0 * x * y,
      lens.fx_px * (r2 + 2.0 * x * x), lens.fx_px * x * r2 * r2 * r2;
  result.by_lens.row(1) << 0.0, yd, 0.0, 1.0, lens.fy_px * y * r2, lens.fy_px * y * r2 * r2,
      lens.fy_px * (r2 + 2.0 * y * y), lens.fy_px * 2.0 * x * y, lens.fy_px * y * r2 * r2 * r2;
  return result;
}

}  // namespace beltpick::calibrate
