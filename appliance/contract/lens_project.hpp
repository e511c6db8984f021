// Where a point appears in the image of a lens: OpenCV's camera model, forwards.
#pragma once

#include "base/pose.hpp"
#include "contract/calibration.hpp"

namespace beltpick {

struct PixelPosition {
  double column_px = 0.0;
  double row_px = 0.0;
};

// The image of a point in front of the lens (z > 0, the lens's own frame, mm). May lie outside the image. Far outside
// the field of view the distortion polynomial is no longer that of a lens and may fold back: `in_field` tells.
inline PixelPosition project(const Lens& lens, const Vec3& point_mm) {
  const double x = point_mm.x() / point_mm.z();
  const double y = point_mm.y() / point_mm.z();
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double distorted_x = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double distorted_y = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {lens.fx_px * distorted_x + lens.cx_px, lens.fy_px * distorted_y + lens.cy_px};
}

// Whether the pinhole image of the point, undistorted, lies inside the image or within a quarter of its size round it.
inline bool in_field(const Lens& lens, const Vec3& point_mm) {
  if (point_mm.z() <= 0.0) return false;
  const double column = lens.fx_px * point_mm.x() / point_mm.z() + lens.cx_px;
  const double row = lens.fy_px * point_mm.y() / point_mm.z() + lens.cy_px;
  return column > -0.25 * lens.width && column < 1.25 * lens.width && row > -0.25 * lens.height &&
         row < 1.25 * lens.height;
}

}  // namespace beltpick
