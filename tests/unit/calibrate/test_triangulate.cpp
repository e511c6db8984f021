#include <catch2/catch.hpp>

#include "calibrate/rigid_fit.hpp"
#include "calibrate/triangulate.hpp"
#include "sample_rig.hpp"

using namespace beltpick;
using namespace beltpick::calibrate;
using beltpick::test::sample_rig;

TEST_CASE("A point is found again from its pixel and its projector column or row", "[calibrate]") {
  const Calibration rig = sample_rig();
  for (const Vec3& point_mm : {Vec3(0, 0, 700), Vec3(-150, 90, 650), Vec3(170, -120, 720), Vec3(60, 110, 600)}) {
    const PixelPosition seen = project(rig.camera, point_mm);
    const PixelPosition lit = project(rig.projector, rig.T_projector_camera * point_mm);
    const auto by_column = triangulate(rig, seen, Axis::kColumn, lit.column_px, 500.0);
    REQUIRE(by_column);
    CHECK((*by_column - point_mm).norm() < 1e-5);
  }
}

TEST_CASE("A row measures where the baseline runs along the rows", "[calibrate]") {
  Calibration rig = sample_rig();
  const Mat3 quarter = Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitZ()).toRotationMatrix();
  rig.T_projector_camera = {quarter * rig.T_projector_camera.rotation, quarter * rig.T_projector_camera.translation_mm};
  rig.projector.fx_px = rig.projector.fy_px = 1600.0;
  CHECK(sensitive_axis(sample_rig()) == Axis::kColumn);
  CHECK(sensitive_axis(rig) == Axis::kRow);
  const Vec3 point_mm(40, -30, 680);
  const PixelPosition lit = project(rig.projector, rig.T_projector_camera * point_mm);
  const auto found = triangulate(rig, project(rig.camera, point_mm), Axis::kRow, lit.row_px, 600.0);
  REQUIRE(found);
  CHECK((*found - point_mm).norm() < 1e-5);
}

TEST_CASE("Where no point can be, none is made up", "[calibrate]") {
  const Calibration rig = sample_rig();
  const PixelPosition centre{640, 480};
  // A column far on the wrong side meets the ray behind the camera.
  CHECK_FALSE(triangulate(rig, centre, Axis::kColumn, 1e5, 700.0));
  Calibration parallel = rig;
  parallel.T_projector_camera.rotation = Mat3::Identity();
  parallel.T_projector_camera.translation_mm = {-200, 0, 0};
  parallel.camera.cx_px = 639.5;
  parallel.projector.cx_px = 455.5;
  CHECK_FALSE(crossing_depth_mm(parallel));
}

TEST_CASE("The images' centres meet where the rig is aimed at", "[calibrate]") {
  const auto depth_mm = crossing_depth_mm(sample_rig());
  REQUIRE(depth_mm);
  CHECK(*depth_mm == Approx(700.0).margin(10.0));
}

TEST_CASE("The best motion between two sets of points is the one that moved them, a change of scale apart",
          "[calibrate]") {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3 shift_mm(10, -20, 30);
  const std::vector<Vec3> from_mm{{0, 0, 0}, {100, 0, 5}, {0, 80, -5}, {90, 70, 20}, {-30, 20, 60}};
  std::vector<Vec3> to_mm;
  for (const Vec3& point_mm : from_mm) to_mm.emplace_back(1.001 * (turn * point_mm) + shift_mm);
  const RigidFit fit = fit_rigid(from_mm, to_mm);
  CHECK((fit.rotation - turn).norm() < 1e-12);
  CHECK(fit.scale == Approx(1.001).epsilon(1e-9));
  CHECK((fit * from_mm[0] - to_mm[0]).norm() < 0.1);
}
