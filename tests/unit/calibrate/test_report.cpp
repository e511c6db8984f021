#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "calibrate/check_report.hpp"
#include "calibrate/compare_report.hpp"
#include "calibrate/report.hpp"
#include "html/page.hpp"
#include "html/plot.hpp"
#include "sample_rig.hpp"
#include "support/json_file.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::calibrate;
using namespace beltpick::test;

namespace {

PoseOutcome sample_outcome_pose(const Calibration& rig, int number) {
  Random random(static_cast<std::uint64_t>(number) + 1);
  PoseOutcome pose;
  pose.capture = "plate_" + std::to_string(number);
  pose.T_camera_plate = sample_pose();
  pose.T_camera_plate.translation_mm += Vec3(30.0 * (number - 2), 15.0 * (number - 2), -12.0 * number);
  pose.distance_mm = pose.T_camera_plate.translation_mm.z();
  pose.tilt_x_deg = 17.0 - 9.0 * number;
  pose.tilt_y_deg = -11.0 + 7.0 * number;
  pose.camera_rms_px = 0.03 + 0.01 * number;
  pose.projector_rms_px = 0.05;
  pose.stereo_rms_px = 0.04;
  pose.held_out = true;
  pose.held_out_rms_mm = 0.012;
  pose.held_out_max_mm = 0.03;
  int corner = 0;
  for (const SeenCorner& seen : seen_by(rig, pose.T_camera_plate)) {
    CornerOutcome one;
    one.corner = corner++;
    one.camera_px = seen.camera_px;
    one.projector_px = seen.projector_px;
    one.camera_residual_px = {random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06)};
    one.projector_residual_px = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    pose.corners.push_back(one);
  }
  return pose;
}

Outcome sample_outcome() {
  Outcome outcome;
  outcome.calibration = sample_rig();
  outcome.board = {11, 8, 20.0};
  for (int i = 0; i < 5; ++i) outcome.poses.push_back(sample_outcome_pose(outcome.calibration, i));
  outcome.poses[3].used = false;
  outcome.poses[3].held_out = false;
  outcome.poses[3].reason = "blurred & <dark>";
  outcome.poses[1].corners[7].used = false;
  outcome.poses[1].corners[7].reason = "off by 3.1 px";
  outcome.poses[2].corners[9].projector_px.column_px = std::nan("");
  outcome.left_out = {
      {"plate_3", -1, "blurred & <dark>", 0.0}, {"plate_1", 7, "far off", 3.1}, {"plate_1", 8, "far off", 2.9}};
  outcome.coverage.camera = {4, 3, {1, 2, 0, 1, 5, 9, 9, 1, 0, 1, 1, 1}};
  outcome.coverage.projector = {4, 3, {1, 2, 0, 0, 5, 9, 9, 1, 0, 1, 1, 1}};
  outcome.coverage.near_mm = 620;
  outcome.coverage.far_mm = 720;
  outcome.coverage.depth_counts = {10, 80, 120, 60, 30};
  outcome.plate.height_mm.assign(88, 0.0);
  for (int i = 0; i < 88; ++i) outcome.plate.height_mm[static_cast<std::size_t>(i)] = 0.0004 * (i - 44);
  outcome.plate.peak_to_valley_mm = 0.035;
  outcome.parameters = {{"camera fx", "px", 2240.0, 0.4}, {"baseline", "mm", 390.0, 0.02}};
  outcome.poses_used = 4;
  outcome.corners_used = 351;
  outcome.camera_rms_px = 0.05;
  outcome.projector_rms_px = 0.06;
  outcome.grade = Grade::kUsable;
  outcome.verdict = {"Held-out plates are measured to 0.012 mm.", "Show the plate also at 560 mm."};
  return outcome;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("The report carries verdict, pictures and what was left out in one file", "[report]") {
  const TempFolder folder;
  REQUIRE(write_report(folder / "report", sample_outcome()));
  const std::string page = file_bytes(folder / "report/index.html");
  CHECK(page.find("Calibration usable: Held-out plates are measured to 0.012 mm. Show the plate also") !=
        std::string::npos);
  CHECK(page.find("blurred &amp; &lt;dark&gt;") != std::string::npos);
  CHECK(page.find("<dark>") == std::string::npos);
  CHECK(page.find("corners 7 (3.10 px), 8 (2.90 px)") != std::string::npos);
  CHECK(count_of(page, "<svg ") == 11);
  CHECK(count_of(page, "</svg>") == 11);
  CHECK(page.find("src=") == std::string::npos);  // nothing beside it is needed
  CHECK(page.find("nan") == std::string::npos);
  CHECK(page.find("inf") == std::string::npos);
}

TEST_CASE("The report's JSON tells all poses, corners and reasons", "[report]") {
  const TempFolder folder;
  REQUIRE(write_report(folder.path(), sample_outcome()));
  const auto json = json_of(folder / "report.json");
  CHECK(json["format"] == "beltpick-calibration-report");
  CHECK(json["grade"] == "usable");
  CHECK(json["poses"].size() == 5);
  CHECK(json["poses"][0]["corners"].size() == 88);
  CHECK(json["poses"][3]["reason"] == "blurred & <dark>");
  CHECK_FALSE(json["poses"][3].contains("held_out"));
  CHECK(json["poses"][2]["corners"][9]["projector_px"][0].is_null());
  CHECK(json["left_out"].size() == 3);
  CHECK(json["parameters"][0]["sigma"] == 0.4);
  CHECK(json["coverage"]["camera"]["share"].get<double>() == Approx(10.0 / 12.0));
}

TEST_CASE("A report of a calibration without a single corner is still a page", "[report]") {
  Outcome outcome = sample_outcome();
  outcome.poses.clear();
  outcome.plate.height_mm.clear();
  outcome.coverage = {};
  outcome.camera_rms_px = outcome.projector_rms_px = 0.0;
  const TempFolder folder;
  REQUIRE(write_report(folder.path(), outcome));
  const std::string page = file_bytes(folder / "index.html");
  CHECK(page.find("nan") == std::string::npos);
  CHECK(page.find("</html>") != std::string::npos);
}

TEST_CASE("A field check is shown with all its corners, also where one axis is not coded", "[report]") {
  const Calibration rig = sample_rig();
  std::vector<SeenCorner> corners = seen_by(rig, sample_pose());
  const bool columns_only = GENERATE(false, true);
  for (SeenCorner& corner : corners) {
    corner.projector_px.column_px += 0.3;
    if (columns_only) corner.projector_px.row_px = std::nan("");
  }
  const auto check = check_plate(rig, corners, 20.0, {});
  REQUIRE(check);
  const TempFolder folder;
  REQUIRE(write_check_report(folder / "report", {"on & belt", "calibration.json"}, *check, 20.0));
  const std::string page = file_bytes(folder / "report/index.html");
  const auto count = [&](const std::string& words) {
    std::size_t found = 0;
    for (std::size_t at = page.find(words); at != std::string::npos; at = page.find(words, at + 1)) ++found;
    return found;
  };
  CHECK(count("<svg") == 4);
  CHECK(page.find("on &amp; belt") != std::string::npos);
  CHECK(page.find(html::escaped(check->verdict())) != std::string::npos);
  CHECK(count(" mm</title>") == corners.size());
  CHECK(count("nan") == 0);
}

TEST_CASE("A plot keeps to its frame's scale and tells ticks", "[report]") {
  html::Plot plot("title & more", {"x", {0.0, 100.0}}, {"y", {0.0, 10.0}}, false, 400, 300);
  plot.dot({50.0, 5.0}, 2.0, {255, 0, 0}, "tip <here>");
  const std::string svg = plot.svg();
  CHECK(svg.find("title &amp; more") != std::string::npos);
  CHECK(svg.find("<title>tip &lt;here&gt;</title>") != std::string::npos);
  // Half way between 62 and 386 px, and between 28 and 256 px.
  CHECK(svg.find("cx='224.0' cy='142.0'") != std::string::npos);
  CHECK(svg.find(">100<") != std::string::npos);
  CHECK(svg.find(">-0<") == std::string::npos);
}

TEST_CASE("Text of any kind is shown as it is", "[report]") {
  CHECK(html::escaped("a<b>&\"'") == "a&lt;b&gt;&amp;&quot;&#39;");
  CHECK(html::formatted("%s", std::string(1000, 'x').c_str()).size() == 1000);
}
