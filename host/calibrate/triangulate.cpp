#include "calibrate/triangulate.hpp"

#include <cmath>

#include "range/lens_model.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kMaxSteps = 60;
constexpr double kConverged = 1e-10;  // of the depth
constexpr double kParallel = 1e-6;    // of the ray's length: sine of the angle between ray and plane of light

// Length along `ray` at which it meets the projector's ideal column (row) `ideal`; nothing where it runs along it.
std::optional<double> meet(const Vec3& ray_projector, const Vec3& origin_projector_mm, int coordinate, double ideal) {
  const double towards = ray_projector[coordinate] - ideal * ray_projector.z();
  if (std::abs(towards) < kParallel * ray_projector.norm()) return std::nullopt;
  return (ideal * origin_projector_mm.z() - origin_projector_mm[coordinate]) / towards;
}

}  // namespace

std::optional<Vec3> ray_of(const Lens& lens, const PixelPosition& pixel) {
  const range::Vec2 seen((pixel.column_px - lens.cx_px) / lens.fx_px, (pixel.row_px - lens.cy_px) / lens.fy_px);
  const auto ideal = range::undistort(lens, seen, seen);
  if (!ideal) return std::nullopt;
  return Vec3(ideal->x(), ideal->y(), 1.0);
}

// The column alone does not tell where on its (curved) line of light the point lies: the row that belongs to the last
// depth is used for the next, which converges in a few steps since the curve is slight.
std::optional<Vec3> triangulate(const Calibration& calibration, const PixelPosition& camera_px, Axis axis,
                                double projector_px, double guess_mm) {
  const auto ray = ray_of(calibration.camera, camera_px);
  if (!ray) return std::nullopt;
  const auto& T = calibration.T_projector_camera;
  const Vec3 ray_projector = T.rotation * *ray;
  const int coordinate = axis == Axis::kColumn ? 0 : 1;
  double depth_mm = guess_mm;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vec3 point_projector_mm = depth_mm * ray_projector + T.translation_mm;
    if (point_projector_mm.z() <= 0.0) return std::nullopt;
    PixelPosition lit = project(calibration.projector, point_projector_mm);
    (axis == Axis::kColumn ? lit.column_px : lit.row_px) = projector_px;
    const auto light = ray_of(calibration.projector, lit);
    if (!light) return std::nullopt;
    const auto next_mm = meet(ray_projector, T.translation_mm, coordinate, (*light)[coordinate]);
    if (!next_mm || !(*next_mm > 0.0)) return std::nullopt;
    const bool done = std::abs(*next_mm - depth_mm) < kConverged * *next_mm;
    depth_mm = *next_mm;
    if (done) return depth_mm * *ray;
  }
  return std::nullopt;
}

std::optional<double> crossing_depth_mm(const Calibration& calibration) {
  const auto centre = [](const Lens& lens) { return PixelPosition{(lens.width - 1) / 2.0, (lens.height - 1) / 2.0}; };
  const auto seen = ray_of(calibration.camera, centre(calibration.camera));
  const auto lit = ray_of(calibration.projector, centre(calibration.projector));
  if (!seen || !lit) return std::nullopt;
  // The point of the camera's ray that is nearest to the projector's.
  const auto T_camera_projector = calibration.T_projector_camera.inverse();
  const Vec3 a = seen->normalized();
  const Vec3 b = (T_camera_projector.rotation * *lit).normalized();
  const double cosine = a.dot(b);
  const double sine2 = 1.0 - cosine * cosine;
  if (sine2 < kParallel) return std::nullopt;
  const Vec3 between_mm = T_camera_projector.translation_mm;
  const double along_mm = (a - cosine * b).dot(between_mm) / sine2;
  const double along_projector_mm = (cosine * a - b).dot(between_mm) / sine2;
  if (along_mm <= 0.0 || along_projector_mm <= 0.0) return std::nullopt;
  return along_mm * a.z();
}

Axis sensitive_axis(const Calibration& calibration) {
  const Vec3& baseline_mm = calibration.T_projector_camera.translation_mm;
  return std::abs(baseline_mm.x()) >= std::abs(baseline_mm.y()) ? Axis::kColumn : Axis::kRow;
}

bool on_image(const Lens& lens, const PixelPosition& pixel) {
  return pixel.column_px >= -0.5 && pixel.column_px <= lens.width - 0.5 && pixel.row_px >= -0.5 &&
         pixel.row_px <= lens.height - 0.5;
}

}  // namespace beltpick::calibrate
