// The belt's wandering is told when it lasts, and only then.
#include <catch2/catch.hpp>

#include "app/belt_watch.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using app::BeltWatch;

namespace {

Calibration rig() {
  Calibration calibration;
  calibration.camera = {1280, 960, 2240.0, 2240.0, 639.5, 479.5, {}};
  return calibration;
}

// A belt 700 mm away, its normal towards the camera.
Cell cell_at(double distance_mm) {
  Cell cell;
  cell.T_belt_camera.emplace();
  cell.T_belt_camera->rotation = Vec3(1.0, -1.0, -1.0).asDiagonal();
  cell.T_belt_camera->translation_mm = {0.0, 0.0, distance_mm};
  return cell;
}

Plane belt_at(double distance_mm, double tilt_rad = 0.0) {
  const Vec3 normal(std::sin(tilt_rad), 0.0, -std::cos(tilt_rad));
  return {normal, normal.z() * distance_mm};
}

// What the last of `count` captures tells.
std::optional<Error> after(BeltWatch& watch, int count, const Plane& belt) {
  std::optional<Error> told;
  for (int i = 0; i < count; ++i) told = watch.see(belt);
  return told;
}

}  // namespace

TEST_CASE("a belt that lies farther than it should is told once some captures agree", "[app]") {
  BeltWatch watch(1.0);
  watch.use(rig(), cell_at(700.0));
  CHECK_FALSE(after(watch, 4, belt_at(701.5)));
  CHECK_FALSE(watch.nearer_mm());
  const auto told = watch.see(belt_at(701.5));
  REQUIRE(told);
  CHECK(told->code == ResultCode::kBeltPlaneWandered);
  CHECK(std::string(told->detail).find("1.50 mm farther") != std::string::npos);
  CHECK(watch.nearer_mm().value() == Approx(-1.5));
  CHECK_FALSE(after(watch, 9, belt_at(699.6)));
  CHECK(watch.nearer_mm().value() == Approx(0.4));
}

TEST_CASE("a belt that tilts is told by the corner where it shows most", "[app]") {
  BeltWatch watch(1.0);
  watch.use(rig(), cell_at(700.0));
  REQUIRE(after(watch, 5, belt_at(700.0, 0.01)));
  CHECK(std::abs(watch.nearer_mm().value()) == Approx(2.0).margin(0.05));  // 200 mm aside
}

TEST_CASE("a box that covers the belt at times is not the belt", "[app]") {
  BeltWatch watch(1.0);
  watch.use(rig(), cell_at(700.0));
  for (int i = 0; i < 40; ++i) CHECK_FALSE(watch.see(belt_at(i % 3 == 0 ? 640.0 : 700.2)));
  CHECK_FALSE(watch.see(std::nullopt));
}

TEST_CASE("a new place of the belt begins anew, the same one goes on", "[app]") {
  BeltWatch watch(1.0);
  watch.use(rig(), cell_at(700.0));
  REQUIRE(after(watch, 5, belt_at(703.0)));
  watch.use(rig(), cell_at(700.0));
  CHECK(watch.nearer_mm());
  watch.use(rig(), cell_at(703.0));
  CHECK_FALSE(watch.nearer_mm());
  CHECK_FALSE(after(watch, 9, belt_at(703.0)));
}

TEST_CASE("without a limit, or a place of the belt, nothing is told", "[app]") {
  BeltWatch unlimited(0.0);
  unlimited.use(rig(), cell_at(700.0));
  CHECK_FALSE(after(unlimited, 9, belt_at(750.0)));
  CHECK(unlimited.nearer_mm().value() == Approx(-50.0));
  BeltWatch nowhere(1.0);
  nowhere.use(rig(), Cell{});
  CHECK_FALSE(after(nowhere, 9, belt_at(750.0)));
  CHECK_FALSE(nowhere.nearer_mm());
}
