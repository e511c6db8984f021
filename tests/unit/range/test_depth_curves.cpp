// Depths and rays from curves against the lens model itself, and when they are not to be used.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "base/units.hpp"
#include "range/curves_fit.hpp"
#include "range/depth_curves.hpp"
#include "range/lens_model.hpp"
#include "range/ray_curves.hpp"

namespace beltpick::testing {
namespace {

constexpr int kRows = 37;
constexpr int kCols = 1237;  // leaves a block in part

struct Cell {
  const char* name;
  double focal_px;
  double camera_k1, projector_k1;
  bool fits;
};

const std::vector<Cell> kCells = {
    {"usual lenses", 2240, -0.15, 0.14, true},
    {"other way round", 2240, 0.1, -0.1, true},
    {"no distortion", 1800, 0.0, 0.0, true},
    {"wide angle", 400, -0.15, 0.14, false},
};

Calibration calibration_of(const Cell& cell) {
  Calibration calibration;
  calibration.camera = {kCols,
                        kRows,
                        cell.focal_px,
                        cell.focal_px * 1.001,
                        0.5 * kCols,
                        400.0,
                        {cell.camera_k1, 0.1, 0.0005, -0.0004, 0.05}};
  calibration.projector = {912, 1140, 1607, 2414, 459, 575, {cell.projector_k1, 0.1, -0.0009, -0.0003, -0.5}};
  auto& pose = calibration.T_projector_camera;
  pose.rotation = Eigen::AngleAxisd(rad_from_deg(30.0), Vec3::UnitY()).toRotationMatrix();
  const Vec3 target(0.0, 0.0, 700.0);
  pose.translation_mm = target - pose.rotation * target;
  return calibration;
}

// One that has been given its memory.
template <class Curves>
class Own {
 public:
  Own(int rows, int cols)
      : block_(bytes(rows, cols)), arena_(block_.data(), block_.bytes()), curves(arena_, rows, cols) {}

 private:
  static std::size_t bytes(int rows, int cols) {
    Arena measuring;
    const Curves measured(measuring, rows, cols);
    return measuring.used_bytes();
  }
  ArenaBlock block_;
  Arena arena_;

 public:
  Curves curves;
};

struct Rays {
  explicit Rays(const Lens& camera) {
    for (int row = 0; row < camera.height; ++row) {
      for (int col = 0; col < camera.width; ++col) {
        const Vec2 seen((col - camera.cx_px) / camera.fx_px, (row - camera.cy_px) / camera.fy_px);
        const auto ideal = range::undistort(camera, seen, seen);
        u.push_back(ideal ? static_cast<float>(ideal->x()) : NAN);
        v.push_back(ideal ? static_cast<float>(ideal->y()) : NAN);
      }
    }
  }
  using Vec2 = range::Vec2;
  std::vector<float> u, v;
};

TEST_CASE("curves are used where they give the lens model's depths, and only there") {
  for (const Cell& cell : kCells) {
    INFO(cell.name);
    const Calibration calibration = calibration_of(cell);
    const Rays rays(calibration.camera);
    Own<range::DepthCurves> own(kRows, kCols);
    own.curves.load(calibration, Axis::kColumn);
    range::AxisModel model = range::axis_model(calibration, Axis::kColumn);
    CHECK(range::curves_fit(model, 912, own.curves, rays.u, rays.v, kCols) == cell.fits);
  }
}

TEST_CASE("the projector's other axis, along which nothing moves with depth, has no curves") {
  const Calibration calibration = calibration_of(kCells.front());
  const Rays rays(calibration.camera);
  Own<range::DepthCurves> own(kRows, kCols);
  own.curves.load(calibration, Axis::kRow);
  CHECK_FALSE(range::curves_fit(range::axis_model(calibration, Axis::kRow), 1140, own.curves, rays.u, rays.v, kCols));
}

TEST_CASE("depths and sigmas from curves are those of the lens model, to the last pixel of a row") {
  const Calibration calibration = calibration_of(kCells.front());
  const Rays rays(calibration.camera);
  Own<range::DepthCurves> own(kRows, kCols);
  own.curves.load(calibration, Axis::kColumn);
  const range::AxisModel model = range::axis_model(calibration, Axis::kColumn);
  std::vector<float> code(kCols), modulation(kCols);
  std::vector<std::uint8_t> texture(kCols);
  for (int i = 0; i < kCols; ++i) {
    const auto at = static_cast<std::size_t>(i);
    code[at] = i % 97 == 5 ? NAN : 100.0F + 0.55F * static_cast<float>(i) + static_cast<float>(i % 13) * 7.0F;
    modulation[at] = i % 31 == 0 ? 0.0F : 20.0F + static_cast<float>(i % 90);
    texture[at] = static_cast<std::uint8_t>(i % 256);
  }
  const std::size_t whole = static_cast<std::size_t>(range::blocks_along(kCols) * range::kBlock);
  std::vector<float> exact_mm(kCols), exact_sigma(kCols), curved_mm(whole), curved_sigma(whole);
  for (const int row : {0, 5, kRows - 1}) {
    const auto first = static_cast<std::size_t>(row) * kCols;
    const range::AxisInput in{&rays.u[first],    &rays.v[first], code.data(),
                              modulation.data(), texture.data(), {0.01F, 1.2F}};
    depth_row(model, in, kCols, exact_mm.data(), exact_sigma.data());
    depth_row(own.curves.row(row), in, kCols, curved_mm.data(), curved_sigma.data());
    int measured = 0;
    for (std::size_t i = 0; i < kCols; ++i) {
      INFO("row " << row << ", column " << i);
      REQUIRE((curved_mm[i] > 0.0F) == (exact_mm[i] > 0.0F));
      if (!(exact_mm[i] > 0.0F)) continue;
      ++measured;
      REQUIRE(curved_mm[i] == Approx(exact_mm[i]).epsilon(1e-5));
      REQUIRE(curved_sigma[i] == Approx(exact_sigma[i]).epsilon(0.01));
    }
    CHECK(measured > kCols / 2);
  }
}

TEST_CASE("parabolas give the rays to less than a thousandth of a pixel") {
  const Calibration calibration = calibration_of(kCells.front());
  const Rays rays(calibration.camera);
  Own<range::RayCurves> own(kRows, kCols);
  REQUIRE(own.curves.load(calibration.camera));
  double worst_px = 0.0;
  for (int row = 0; row < kRows; ++row) {
    const range::RayRow curves = own.curves.row(row);
    const auto along = [](const range::RayCurve& curve, int col) {
      const int block = col / range::kBlock;
      const auto t = static_cast<float>(col % range::kBlock);
      return curve.at[block] + t * (curve.slope[block] + t * curve.bend[block]);
    };
    for (int col = 0; col < kCols; ++col) {
      const auto at = static_cast<std::size_t>(row) * kCols + static_cast<std::size_t>(col);
      worst_px = std::max({worst_px, calibration.camera.fx_px * std::fabs(along(curves.curve_u, col) - rays.u[at]),
                           calibration.camera.fy_px * std::fabs(along(curves.curve_v, col) - rays.v[at])});
    }
  }
  CHECK(worst_px < 1e-3);
}

}  // namespace
}  // namespace beltpick::testing
