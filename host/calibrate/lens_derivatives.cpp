#include "calibrate/lens_derivatives.hpp"

#include "range/lens_model.hpp"

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
  const range::Vec2 ideal = point_mm.head<2>() * inverse_z;
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = ideal.squaredNorm();
  const range::Vec2 bent = range::distort(lens, ideal);
  Eigen::Matrix<double, 2, 3> by_point;  // d ideal / d point
  by_point << inverse_z, 0.0, -x * inverse_z, 0.0, inverse_z, -y * inverse_z;

  ProjectedPoint result;
  const Eigen::Vector2d focal(lens.fx_px, lens.fy_px);
  result.at_px = {lens.fx_px * bent.x() + lens.cx_px, lens.fy_px * bent.y() + lens.cy_px};
  result.by_point = focal.asDiagonal() * (range::distort_jacobian(lens, ideal) * by_point);
  result.by_lens.row(0) << bent.x(), 0.0, 1.0, 0.0, lens.fx_px * x * r2, lens.fx_px * x * r2 * r2,
      lens.fx_px * 2.0 * x * y, lens.fx_px * (r2 + 2.0 * x * x), lens.fx_px * x * r2 * r2 * r2;
  result.by_lens.row(1) << 0.0, bent.y(), 0.0, 1.0, lens.fy_px * y * r2, lens.fy_px * y * r2 * r2,
      lens.fy_px * (r2 + 2.0 * y * y), lens.fy_px * 2.0 * x * y, lens.fy_px * y * r2 * r2 * r2;
  return result;
}

}  // namespace beltpick::calibrate
