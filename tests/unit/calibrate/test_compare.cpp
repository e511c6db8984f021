#include <catch2/catch.hpp>

#include "calibrate/compare.hpp"
#include "calibrate/compare_report.hpp"
#include "contract/result_codes.hpp"
#include "sample_rig.hpp"
#include "support/one_line.hpp"

using namespace beltpick;
using namespace beltpick::calibrate;
using beltpick::test::sample_rig;

TEST_CASE("A calibration does not differ from itself", "[calibrate]") {
  const auto same = compare(sample_rig(), sample_rig(), {}, {});
  REQUIRE(same);
  CHECK(same->volume.max_mm < 1e-5);
  CHECK(same->belt.points > 400);
  CHECK(same->volume.points > 4 * same->belt.points);
  CHECK(same->distance_guessed);
}

TEST_CASE("A camera frame that only moved differs until the best motion is taken out", "[calibrate]") {
  // The same rig with its camera's frame, and the whole of what it sees, scaled: a longer baseline measures larger.
  Calibration longer = sample_rig();
  longer.T_projector_camera.translation_mm *= 1.001;
  CompareOptions options;
  options.distance_mm = 700.0;
  const auto difference = compare(sample_rig(), longer, {}, options);
  REQUIRE(difference);
  CHECK_FALSE(difference->distance_guessed);
  CHECK(difference->distance_mm == Approx(700.0));
  // Everything grows by a thousandth about the camera: 0.7 mm at the belt's middle, of which a motion takes most.
  CHECK(difference->belt.rms_mm == Approx(0.72).margin(0.03));
  CHECK(difference->belt_moved.rms_mm < 0.2);
  CHECK(difference->motion.scale == Approx(1.0 / 1.001).epsilon(1e-6));
  CHECK(motion_mm(*difference) == Approx(0.7).margin(0.05));
}

TEST_CASE("The belt of the cell is where the difference is told", "[calibrate]") {
  Cell cell;
  Pose<frame::Camera, frame::Belt> T_camera_belt;
  T_camera_belt.rotation = Eigen::AngleAxisd(3.141592653589793, Vec3::UnitX()).toRotationMatrix();
  T_camera_belt.translation_mm = {0, 0, 640};
  cell.T_belt_camera = T_camera_belt.inverse();
  const auto difference = compare(sample_rig(), sample_rig(), cell, {});
  REQUIRE(difference);
  CHECK(difference->distance_mm == Approx(640.0));
  for (const ComparedPoint& point : difference->points) {
    if (point.layer == 0) CHECK(point.old_mm.z() == Approx(640.0));
    if (point.layer == 5) CHECK(point.old_mm.z() == Approx(540.0));
  }
}

TEST_CASE("What cannot be compared is refused with the reason", "[calibrate]") {
  Calibration other = sample_rig();
  other.camera.width = 640;
  const auto sizes = compare(sample_rig(), other, {}, {});
  REQUIRE_FALSE(sizes);
  CHECK(sizes.error().code == ResultCode::kCalibrationMismatch);
  CHECK(test::mentions(sizes.error(), "640x960"));
  CompareOptions near;
  near.distance_mm = 150.0;
  const auto apart = compare(sample_rig(), sample_rig(), {}, near);
  REQUIRE_FALSE(apart);
  CHECK(apart.error().code == ResultCode::kTooFewPoints);
}
