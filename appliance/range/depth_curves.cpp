#include "range/depth_curves.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "base/units.hpp"
#include "contract/lens_project.hpp"
#include "range/lens_model.hpp"

namespace beltpick::range {
namespace {

constexpr int kRowsApart = 4;  // of corners: between them, curves are interpolated in proportion
constexpr int corner_rows(int rows) { return (rows - 1) / kRowsApart + 2; }

constexpr int kSamples = 16;
constexpr double kBeyondPx = 1.0;     // codes reach this far outside the projector, by noise
constexpr double kOutsidePx = 100.0;  // a ray that stays this far outside along the other axis needs no curve

// Codes along one ray, and what belongs to them.
struct Samples {
  std::array<double, kSamples> code_px{}, per_z{}, other_px{};
  bool whole = true;  // all codes have their place in front of the projector
  bool near = false;  // some are within reach of what it lights
};

// The projector along the coded axis s and the other one, o.
struct Projector {
  Projector(const Calibration& calibration, Axis axis)
      : lens(calibration.projector),
        T_projector_camera(calibration.T_projector_camera),
        s(axis == Axis::kColumn ? 0 : 1) {
    const std::array<double, 2> size{static_cast<double>(lens.width), static_cast<double>(lens.height)};
    extent_s = size[static_cast<std::size_t>(s)];
    extent_o = size[static_cast<std::size_t>(1 - s)];
  }

  // The pixel position along s and o of the ray's point at 1 / z; nothing behind the lens.
  [[nodiscard]] std::optional<Vec2> image(const Vec3& ray, double per_z) const {
    const Vec3 point = T_projector_camera.rotation * ray + T_projector_camera.translation_mm * per_z;
    if (!(point.z() > 0.0)) return std::nullopt;
    const auto seen = project(lens, point);
    return s == 0 ? Vec2(seen.column_px, seen.row_px) : Vec2(seen.row_px, seen.column_px);
  }
  // Where the ray's ideal image stands at s, as 1 / z.
  [[nodiscard]] double per_z(const Vec3& ray, double ideal_s) const {
    const Vec3 q = T_projector_camera.rotation * ray;
    const Vec3& t = T_projector_camera.translation_mm;
    return (ideal_s * q.z() - q[s]) / (t[s] - ideal_s * t.z());
  }
  [[nodiscard]] double focal_px() const { return s == 0 ? lens.fx_px : lens.fy_px; }
  [[nodiscard]] double centre_px() const { return s == 0 ? lens.cx_px : lens.cy_px; }

  const Lens& lens;
  const Pose<frame::Projector, frame::Camera>& T_projector_camera;
  int s;
  double extent_s = 0.0, extent_o = 0.0;
};

// Sets the ray's place of code_px. The lens shifts the code by little and evenly: what is missing is added until
// nothing is.
bool find_code(const Projector& projector, const Vec3& ray, double code_px, double& per_z, double& other_px) {
  constexpr int kMostSteps = 30;
  constexpr double kConvergedPx = 1e-6;
  double s = (code_px - projector.centre_px()) / projector.focal_px();
  for (int step = 0; step < kMostSteps; ++step) {
    per_z = projector.per_z(ray, s);
    const auto seen = projector.image(ray, per_z);
    if (!seen) return false;
    other_px = seen->y();
    const double missing_px = code_px - seen->x();
    if (std::fabs(missing_px) < kConvergedPx) return true;
    s += missing_px / projector.focal_px();
  }
  return false;
}

Samples samples_of(const Projector& projector, const Vec3& ray) {
  Samples samples;
  for (std::size_t k = 0; k < kSamples; ++k) {
    // Chebyshev's places: there, polynomials are held best between them.
    const double unit = 0.5 - 0.5 * std::cos(kPi * (static_cast<double>(k) + 0.5) / kSamples);
    samples.code_px[k] = -0.5 - kBeyondPx + unit * (projector.extent_s + 2.0 * kBeyondPx);
    const bool found = find_code(projector, ray, samples.code_px[k], samples.per_z[k], samples.other_px[k]);
    samples.whole = samples.whole && found;
    const double other_px = samples.other_px[k];
    samples.near = samples.near || (found && other_px > -kOutsidePx && other_px < projector.extent_o + kOutsidePx);
  }
  return samples;
}

// The terms in x of the polynomial in x / scale through `values`, by least squares.
template <int kTerms>
void fit(const std::array<double, kSamples>& x, const std::array<double, kSamples>& values, double scale,
         float* terms) {
  Eigen::Matrix<double, kTerms, kTerms> normal = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Eigen::Matrix<double, kTerms, 1> right = Eigen::Matrix<double, kTerms, 1>::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Eigen::Matrix<double, kTerms, 1> powers;
    powers[0] = 1.0;
    for (int k = 1; k < kTerms; ++k) powers[k] = powers[k - 1] * x[at];
    normal += powers * powers.transpose();
    right += values[at] * powers;
  }
  const Eigen::Matrix<double, kTerms, 1> solved = normal.ldlt().solve(right);
  double per_power = 1.0;
  for (int k = 0; k < kTerms; ++k, per_power /= scale) terms[k] = static_cast<float>(solved[k] * per_power);
}

// Behind everything and beside the projector: no code means a depth on this ray.
constexpr Curve kNoDepths{.other_px = {1e9F}};

Curve curve_of(const Projector& projector, const Vec3& ray, double centre_px) {
  Curve curve = kNoDepths;
  curve.length_squared = static_cast<float>(ray.squaredNorm());
  const Samples samples = samples_of(projector, ray);
  if (!samples.whole || !samples.near) return curve;
  std::array<double, kSamples> x{};
  for (std::size_t i = 0; i < kSamples; ++i) x[i] = (samples.code_px[i] - centre_px) / centre_px;
  fit<kDepthTerms>(x, samples.per_z, centre_px, curve.per_z.data());
  fit<kOtherTerms>(x, samples.other_px, centre_px, curve.other_px.data());
  return curve;
}

}  // namespace

DepthCurves::DepthCurves(Arena& arena, int rows, int cols) {
  const auto across = static_cast<std::size_t>(corners_along(cols));
  corners_ = arena.take<Curve>("depth curves", across * static_cast<std::size_t>(corner_rows(rows)));
  at_ = arena.take<Curve>("depth curves", across);
  slope_ = arena.take<Curve>("depth curves", across);
  bend_ = arena.take<Curve>("depth curves", across);
  row_.at = at_.data();
  row_.slope = slope_.data();
  row_.bend = bend_.data();
}

void DepthCurves::load(const Calibration& calibration, Axis axis) {
  const Lens& camera = calibration.camera;
  const Projector projector(calibration, axis);
  const double centre_px = 0.5 * (projector.extent_s - 1.0);
  across_ = corners_along(camera.width);
  row_.centre_px = static_cast<float>(centre_px);
  row_.first_other_px = -0.5F - kModelSlackPx;
  row_.last_other_px = static_cast<float>(projector.extent_o) - 0.5F + kModelSlackPx;
  std::size_t at = 0;
  for (int corner_row = 0; corner_row < corner_rows(camera.height); ++corner_row) {
    for (int corner = 0; corner < across_; ++corner, ++at) {
      const Vec2 seen(((corner - 1) * kBlock - camera.cx_px) / camera.fx_px,
                      (corner_row * kRowsApart - camera.cy_px) / camera.fy_px);
      const auto ideal = undistort(camera, seen, seen);
      corners_[at] = ideal ? curve_of(projector, Vec3(ideal->x(), ideal->y(), 1.0), centre_px) : kNoDepths;
    }
  }
}

const CurveRow& DepthCurves::row(int row) {
  const Curve* up = &corners_[static_cast<std::size_t>(row / kRowsApart) * static_cast<std::size_t>(across_)];
  const float below = static_cast<float>(row % kRowsApart) / kRowsApart;
  curves_between(up, up + across_, below, across_ - 3, at_.data(), slope_.data(), bend_.data());
  return row_;
}

}  // namespace beltpick::range
