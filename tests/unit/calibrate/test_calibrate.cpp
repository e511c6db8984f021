// From exact projections of known plates by a known rig: what calibration finds, leaves out and refuses.
#include <algorithm>
#include <catch2/catch.hpp>

#include "calibrate/calibrate.hpp"
#include "calibrate/compare.hpp"
#include "contract/result_codes.hpp"
#include "synthetic_plates.hpp"

using namespace beltpick;
using namespace beltpick::test;
using calibrate::Grade;
using calibrate::LeftOut;
using calibrate::Observations;

namespace {

// How far apart both measure in the volume, after the best rigid motion, which no plate tells.
double difference_mm(const Calibration& found, const Calibration& truth) {
  calibrate::CompareOptions options;
  options.distance_mm = 700.0;
  const auto comparison = calibrate::compare(truth, found, std::nullopt, options);
  REQUIRE(comparison);
  return comparison->volume_moved.rms_mm;
}

bool is_left_out(const std::vector<LeftOut>& all, const std::string& capture, int corner) {
  return std::any_of(all.begin(), all.end(),
                     [&](const LeftOut& one) { return one.capture == capture && one.corner == corner; });
}

}  // namespace

TEST_CASE("exact corners give the rig again", "[calibrate]") {
  const Calibration truth = sample_rig();
  const auto outcome = calibrate::calibrate(observe_plates(truth, {}));
  REQUIRE(outcome);
  CHECK(outcome->camera_rms_px < 2e-3);
  CHECK(outcome->projector_rms_px < 2e-3);
  CHECK(difference_mm(outcome->calibration, truth) < 2e-3);
  CHECK(outcome->held_out_rms_mm < 2e-3);
  CHECK(outcome->left_out.empty());
  CHECK(outcome->plate.peak_to_valley_mm < 2e-3);
  CHECK(outcome->calibration.camera.fx_px == Approx(truth.camera.fx_px).epsilon(1e-4));
  CHECK(outcome->calibration.projector.fy_px == Approx(truth.projector.fy_px).epsilon(1e-3));
}

TEST_CASE("the plate's bend is found and does not spoil the rig", "[calibrate]") {
  const Calibration truth = sample_rig();
  PlateSet set;
  set.bend_mm = 0.2;
  const auto outcome = calibrate::calibrate(observe_plates(truth, set));
  REQUIRE(outcome);
  for (int corner = 0; corner < 88; ++corner) {
    INFO(corner);
    CHECK(outcome->plate.height_mm[static_cast<std::size_t>(corner)] == Approx(bent_mm(set, corner % 11)).margin(0.01));
  }
  CHECK(difference_mm(outcome->calibration, truth) < 5e-3);
}

TEST_CASE("of a plate that looks alike both ways the common bend is found", "[calibrate]") {
  PlateSet set;
  set.columns = 9;
  set.rows = 7;
  set.bend_mm = 0.2;
  Observations seen = observe_plates(sample_rig(), set);
  for (std::size_t p = 0; p < seen.poses.size(); p += 2) {  // numbered from the other end
    for (auto& corner : seen.poses[p].corners) corner.corner = 62 - corner.corner;
  }
  const auto outcome = calibrate::calibrate(seen);
  REQUIRE(outcome);
  CHECK(outcome->plate.symmetric);
  CHECK(outcome->plate.height_mm[0] == Approx(bent_mm(set, 0)).margin(0.02));
  CHECK(difference_mm(outcome->calibration, sample_rig()) < 0.01);
}

TEST_CASE("the stated uncertainty is that of repeated calibrations", "[calibrate]") {
  PlateSet set;
  set.noise_px = 0.05;
  double squares = 0.0, stated = 0.0, points = 0.0, differences = 0.0;
  constexpr int kRepeats = 8;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    set.seed = 100 + static_cast<std::uint64_t>(repeat);
    const auto outcome = calibrate::calibrate(observe_plates(sample_rig(), set));
    REQUIRE(outcome);
    CHECK(outcome->camera_rms_px == Approx(0.05 * std::sqrt(2.0)).epsilon(0.2));
    const auto& focal = outcome->parameters.front();
    REQUIRE(focal.name == "camera fx");
    squares += (focal.value - 2240.0) * (focal.value - 2240.0) / kRepeats;
    stated += focal.sigma * focal.sigma / kRepeats;
    points += outcome->point_sigma_mm / kRepeats;
    differences += difference_mm(outcome->calibration, sample_rig()) / kRepeats;
  }
  CHECK(std::sqrt(squares / stated) > 0.4);
  CHECK(std::sqrt(squares / stated) < 2.0);
  CHECK(differences / points > 0.3);
  CHECK(differences / points < 4.0);  // the volume compared reaches further than the plates did
}

TEST_CASE("bad corners are left out and named, and do no harm", "[calibrate]") {
  PlateSet set;
  set.noise_px = 0.02;
  Observations seen = observe_plates(sample_rig(), set);
  seen.poses[2].corners[17].camera_px.column_px += 3.0;
  seen.poses[4].corners[40].camera_px.row_px -= 1.0;
  seen.poses[5].corners[60].projector_px.column_px += 18.0;  // a fringe's period
  const auto outcome = calibrate::calibrate(seen);
  REQUIRE(outcome);
  CHECK(outcome->corners_left_out == 3);
  CHECK(is_left_out(outcome->left_out, "pose2", 17));
  CHECK(is_left_out(outcome->left_out, "pose4", 40));
  CHECK(is_left_out(outcome->left_out, "pose5", 60));
  CHECK(outcome->left_out[0].reason.find("px off") != std::string::npos);
  CHECK_FALSE(outcome->poses[2].corners[17].used);
  CHECK(outcome->poses[2].corners[17].reason == outcome->left_out[0].reason);
  CHECK(difference_mm(outcome->calibration, sample_rig()) < 0.02);
}

TEST_CASE("a plate that moved between the frames is left out and named", "[calibrate]") {
  PlateSet set;
  set.noise_px = 0.02;
  Observations seen = observe_plates(sample_rig(), set);
  for (auto& corner : seen.poses[6].corners) {  // both axes are coded one after the other
    corner.projector_px.column_px += 2.0 + 0.02 * corner.corner;
    corner.projector_px.row_px -= 3.0;
  }
  const auto outcome = calibrate::calibrate(seen);
  REQUIRE(outcome);
  CHECK(outcome->poses_used == 9);
  CHECK_FALSE(outcome->poses[6].used);
  CHECK(is_left_out(outcome->left_out, "pose6", -1));
  CHECK(outcome->poses[6].reason.find("did the plate move") != std::string::npos);
  CHECK(difference_mm(outcome->calibration, sample_rig()) < 0.02);
}

TEST_CASE("poses that determine nothing are refused with what to capture next", "[calibrate]") {
  PlateSet set;
  set.noise_px = 0.02;
  SECTION("too few") {
    set.poses = 2;
    const auto outcome = calibrate::calibrate(observe_plates(sample_rig(), set));
    REQUIRE_FALSE(outcome);
    CHECK(outcome.error().code == ResultCode::kTooFewPoints);
    CHECK(outcome.error().text().find("capture more poses") != std::string_view::npos);
  }
  SECTION("parallel plates") {
    set.tilt_rad = 0.01;
    const auto outcome = calibrate::calibrate(observe_plates(sample_rig(), set));
    REQUIRE_FALSE(outcome);
    CHECK(outcome.error().code == ResultCode::kCheckFailed);
    CHECK(outcome.error().text().find("tilt the plate") != std::string_view::npos);
  }
  SECTION("too little of the view") {
    set.columns = 5;
    set.rows = 4;
    set.shift_mm = 10.0;
    const auto outcome = calibrate::calibrate(observe_plates(sample_rig(), set));
    REQUIRE_FALSE(outcome);
    CHECK(outcome.error().code == ResultCode::kCheckFailed);
    CHECK(outcome.error().text().find("view") != std::string_view::npos);
  }
}

TEST_CASE("few poses, or poses to one side, are told in the verdict", "[calibrate]") {
  PlateSet set;
  set.poses = 4;
  set.noise_px = 0.02;
  set.shift_mm = 20.0;
  const auto outcome = calibrate::calibrate(observe_plates(sample_rig(), set));
  REQUIRE(outcome);
  CHECK(outcome->grade != Grade::kGood);
  std::string all;
  for (const std::string& sentence : outcome->verdict) all += sentence + " ";
  INFO(all);
  CHECK(all.find("4 poses") != std::string::npos);
  CHECK(all.find("view is covered") != std::string::npos);
}

TEST_CASE("the same corners give the same bits", "[calibrate]") {
  PlateSet set;
  set.noise_px = 0.05;
  const Observations seen = observe_plates(sample_rig(), set);
  const auto once = calibrate::calibrate(seen);
  const auto again = calibrate::calibrate(seen);
  REQUIRE(once);
  REQUIRE(again);
  CHECK(once->calibration == again->calibration);
  CHECK(once->point_sigma_mm == again->point_sigma_mm);
}
