#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "calibrate/plate_check.hpp"
#include "contract/result_codes.hpp"
#include "sample_rig.hpp"
#include "support/one_line.hpp"

using namespace beltpick;
using namespace beltpick::calibrate;
using namespace beltpick::test;

namespace {

std::vector<SeenCorner> noisy(std::vector<SeenCorner> corners, double noise_px) {
  Random random(5);
  const auto noise = [&] { return noise_px * (random.uniform() + random.uniform() + random.uniform() - 1.5) * 2.0; };
  for (SeenCorner& corner : corners) {
    corner.camera_px.column_px += noise();
    corner.camera_px.row_px += noise();
    corner.projector_px.column_px += noise();
    corner.projector_px.row_px += noise();
  }
  return corners;
}

const CheckedFigure& figure(const PlateCheck& check, const std::string& name) {
  for (const CheckedFigure& one : check.figures) {
    if (one.name == name) return one;
  }
  throw std::runtime_error(name);
}

}  // namespace

TEST_CASE("A plate without noise is measured as it is", "[calibrate]") {
  const Calibration rig = sample_rig();
  const auto check = check_plate(rig, seen_by(rig, sample_pose()), 20.0, {});
  REQUIRE(check);
  CHECK(check->good());
  CHECK(check->verdict() == "in tolerance");
  CHECK(check->corners.size() == 88);
  for (const CheckedFigure& one : check->figures) {
    INFO(one.name);
    CHECK(one.value_mm < 1e-4);
  }
  CHECK(check->distance_mm == Approx(690.0).margin(1.0));
}

TEST_CASE("A plate seen with the usual noise is in tolerance", "[calibrate]") {
  const Calibration rig = sample_rig();
  const auto check = check_plate(rig, noisy(seen_by(rig, sample_pose()), 0.03), 20.0, {});
  REQUIRE(check);
  INFO(check->verdict());
  CHECK(check->good());
  CHECK(check->camera_rms_px > 0.01);
}

TEST_CASE("A plate is measured by the columns alone where only they are coded", "[calibrate]") {
  const Calibration rig = sample_rig();
  auto corners = seen_by(rig, sample_pose());
  for (SeenCorner& corner : corners) corner.projector_px.row_px = std::nan("");
  const auto check = check_plate(rig, corners, 20.0, {});
  REQUIRE(check);
  CHECK(check->good());
  CHECK(std::abs(check->distance_error_mm) < 1e-4);
}

TEST_CASE("A projector that drifted since the calibration is out of tolerance, and it is told by how much",
          "[calibrate]") {
  const Calibration rig = sample_rig();
  Calibration drifted = rig;
  SECTION("along the baseline") {
    drifted.projector.cx_px += 0.6;
    const auto check = check_plate(rig, noisy(seen_by(drifted, sample_pose()), 0.03), 20.0, {});
    REQUIRE(check);
    CHECK_FALSE(check->good());
    CHECK_FALSE(figure(*check, "distance").good());
    CHECK(check->verdict().find("out of tolerance") == 0);
    CHECK(std::abs(check->projector_shift_px.column_px) == Approx(0.6).margin(0.05));
  }
  SECTION("across it") {
    drifted.projector.cy_px += 0.8;
    const auto check = check_plate(rig, noisy(seen_by(drifted, sample_pose()), 0.03), 20.0, {});
    REQUIRE(check);
    CHECK_FALSE(figure(*check, "projector").good());
    CHECK(check->projector_shift_px.row_px == Approx(0.8).margin(0.05));
  }
  SECTION("the camera's lens got longer") {
    drifted.camera.fx_px *= 1.0005;
    drifted.camera.fy_px *= 1.0005;
    const auto check = check_plate(rig, noisy(seen_by(drifted, sample_pose()), 0.03), 20.0, {});
    REQUIRE(check);
    CHECK_FALSE(check->good());
  }
}

TEST_CASE("A plate of another size than said is not taken for a drift of the rig in silence", "[calibrate]") {
  const Calibration rig = sample_rig();
  auto corners = seen_by(rig, sample_pose());
  for (SeenCorner& corner : corners) corner.plate_mm *= 1.005;
  const auto slightly = check_plate(rig, corners, 20.1, {});
  REQUIRE(slightly);
  CHECK_FALSE(figure(*slightly, "size").good());
  CHECK(slightly->size_error_mm < -1.0);
  for (SeenCorner& corner : corners) corner.plate_mm *= 1.5;
  const auto other = check_plate(rig, corners, 30.0, {});
  REQUIRE_FALSE(other);
  CHECK(other.error().code == ResultCode::kCalibrationMismatch);
  CHECK(is_one_line(other.error()));
  CHECK(mentions(other.error(), "--square-mm"));
}

TEST_CASE("A few corners are no check", "[calibrate]") {
  const Calibration rig = sample_rig();
  auto corners = seen_by(rig, sample_pose());
  corners.resize(11);
  const auto check = check_plate(rig, corners, 20.0, {});
  REQUIRE_FALSE(check);
  CHECK(check.error().code == ResultCode::kTooFewPoints);
}
