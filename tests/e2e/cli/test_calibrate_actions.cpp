// beltpick calibrate diff, belt, verify and --resume: with right and with wrong input.
#include <catch2/catch.hpp>
#include <fstream>

#include "support/json_file.hpp"
#include "workshop.hpp"

using namespace beltpick::test;

namespace {

// The workshop's calibration with another principal point of the projector.
std::string shifted_calibration(const TempFolder& folder, double shift_px) {
  nlohmann::json calibration = json_of(workshop() / "scene/calibration.json");
  calibration["projector"]["matrix"][0][2] = calibration["projector"]["matrix"][0][2].get<double>() + shift_px;
  calibration["id"] = "shifted";
  return folder.file("shifted.json", calibration.dump());
}

std::string scene_file(const std::string& name) { return (workshop() / ("scene/" + name)).string(); }

// The bare belt, seen by a small rig.
const TempFolder& bare_belt() {
  static const TempFolder folder;
  static const bool made = [] {
    must_run("simulate --scene bare --camera 320x240 --projector 304x380 --seed 3 --out " + (folder / "bare").string());
    return true;
  }();
  (void)made;
  return folder;
}

void check_refused(const std::string& arguments, int exit_code, const std::string& words) {
  const Outcome outcome = beltpick_run(arguments);
  INFO(arguments << ": " << outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.error_lines() == 1);
  CHECK(outcome.err.find(words) != std::string::npos);
  CHECK(outcome.out.empty());
}

}  // namespace

TEST_CASE("calibrate diff tells in mm what a shifted projector does", "[calibrate]") {
  const TempFolder folder;
  const std::string old_file = scene_file("calibration.json");
  const std::string new_file = shifted_calibration(folder, 0.5);
  const Outcome outcome = beltpick_run("calibrate diff " + old_file + " " + new_file + " --cell " +
                                       scene_file("cell.json") + " --json --report " + (folder / "report").string());
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto answer = nlohmann::json::parse(outcome.out);
  CHECK(answer["belt_distance_guessed"] == false);
  CHECK(answer["belt_distance_mm"].get<double>() == Approx(700.0).margin(1.0));
  // Half a column of 152 over 400 mm, seen under 30 degrees.
  CHECK(answer["as_they_stand"]["belt"]["rms_mm"].get<double>() > 1.0);
  CHECK(answer["after_best_motion"]["belt"]["rms_mm"].get<double>() <
        0.3 * answer["as_they_stand"]["belt"]["rms_mm"].get<double>());
  CHECK(answer["parameters"].size() == 20);
  const std::string page = file_bytes(folder / "report/index.html");
  CHECK(page.find("<svg") != std::string::npos);
  CHECK(page.find("</html>") != std::string::npos);

  const Outcome same = beltpick_run("calibrate diff " + old_file + " " + old_file);
  CHECK(same.exit_code == 0);
  CHECK(same.out.find("up to 0.000 mm at the belt") != std::string::npos);
}

TEST_CASE("calibrate diff refuses what cannot be compared in one line", "[calibrate]") {
  const TempFolder folder;
  const std::string old_file = scene_file("calibration.json");
  nlohmann::json other = json_of(old_file);
  other["camera"]["width"] = 640;
  const std::string larger = folder.file("larger.json", other.dump());
  nlohmann::json cell = json_of(scene_file("cell.json"));
  cell.erase("belt_from_camera");
  const std::string no_belt = folder.file("no_belt.json", cell.dump());
  check_refused("calibrate diff " + old_file + " " + larger, 1, "640x120");
  check_refused("calibrate diff " + old_file + " nowhere.json", 1, "nowhere.json");
  check_refused("calibrate diff " + old_file, 2, "NEW");
  check_refused("calibrate diff " + old_file + " " + old_file + " --cell " + no_belt, 1, "belt_from_camera");
  check_refused("calibrate diff " + old_file + " " + old_file + " --distance-mm -3", 2, "--distance-mm");
}

TEST_CASE("calibrate belt finds the bare belt and keeps what else the cell file tells", "[calibrate]") {
  const TempFolder folder;
  const std::string bare = (bare_belt() / "bare").string();
  const std::string options = "calibrate belt " + bare + " --calibration " + bare + "/calibration.json --out ";
  const std::string fresh = (folder / "fresh.json").string();
  const Outcome made = beltpick_run(options + fresh);
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
  CHECK(made.out.find("does not tell its direction of travel") != std::string::npos);
  const auto truth = json_of(bare + "/cell.json");
  const auto found = json_of(fresh);
  CHECK(found["calibration_id"] == truth["calibration_id"]);
  for (int c = 0; c < 3; ++c) {  // the belt's normal; the origin may lie anywhere on it
    CHECK(found["belt_from_camera"][2][c].get<double>() ==
          Approx(truth["belt_from_camera"][2][c].get<double>()).margin(5e-4));
  }
  CHECK(found["belt_from_camera"][2][3].get<double>() ==
        Approx(truth["belt_from_camera"][2][3].get<double>()).margin(0.2));

  nlohmann::json earlier = truth;
  earlier["belt_from_camera"][0][3] = 123.0;
  earlier["note"] = "stays";
  const std::string kept = folder.file("kept.json", earlier.dump());
  const Outcome updated = beltpick_run(options + kept + " --json");
  INFO(updated.err);
  REQUIRE(updated.exit_code == 0);
  CHECK(nlohmann::json::parse(updated.out)["axes_kept"] == true);
  const auto after = json_of(kept);
  CHECK(after["note"] == "stays");
  CHECK(after["robot_from_camera"] == truth["robot_from_camera"]);
  CHECK(after["belt_from_camera"][0][3].get<double>() == Approx(123.0).margin(0.1));
}

TEST_CASE("calibrate belt refuses what would mislead a robot in one line", "[calibrate]") {
  const TempFolder folder;
  const std::string bare = (bare_belt() / "bare").string();
  const std::string calibration = " --calibration " + bare + "/calibration.json";
  nlohmann::json other = json_of(bare + "/cell.json");
  other["calibration_id"] = "another";
  const std::string cell = folder.file("cell.json", other.dump());
  const std::string before = file_bytes(cell);
  check_refused("calibrate belt " + bare + calibration + " --out " + cell, 1, "robot_from_camera");
  CHECK(file_bytes(cell) == before);
  check_refused("calibrate belt " + bare + " --out " + cell, 2, "--calibration");
  check_refused("calibrate belt nowhere" + calibration + " --out " + (folder / "new.json").string(), 1, "nowhere");
  check_refused("calibrate belt " + bare + " --calibration " + scene_file("calibration.json") + " --out " +
                    (folder / "new.json").string(),
                1, "160x120");
  CHECK_FALSE(std::filesystem::exists(folder / "new.json"));
}

namespace {

constexpr const char* kSmallRig = " --camera 640x480 --projector 456x570 --out ";
constexpr const char* kBoard = " --board 11x8 --square-mm 20";

// Holds calibration.json with its observations, from eight plates of a small rig, and on_belt, one more plate of it.
const TempFolder& calibrated() {
  static const TempFolder folder;
  static const bool made = [] {
    must_run("simulate --scene plate --count 8 --seed 4" + std::string(kSmallRig) + (folder / "plates").string());
    must_run("simulate --scene plate-on-belt --seed 5" + std::string(kSmallRig) + (folder / "on_belt").string());
    must_run("calibrate " + (folder / "plates").string() + kBoard + " --out " + (folder / "calibration.json").string() +
             " --report " + (folder / "report").string());
    return true;
  }();
  (void)made;
  return folder;
}

std::string calibration_option() { return " --calibration " + (calibrated() / "calibration.json").string(); }

}  // namespace

TEST_CASE("calibrate verify says of one plate that the calibration holds, and that a drifted one does not",
          "[calibrate]") {
  const std::string capture = (calibrated() / "on_belt").string();
  const Outcome good = beltpick_run("calibrate verify " + capture + calibration_option() + kBoard + " --json");
  INFO(good.err);
  REQUIRE(good.exit_code == 0);
  const auto answer = nlohmann::json::parse(good.out);
  CHECK(answer["good"] == true);
  CHECK(answer["corners"] == 88);
  CHECK(answer["figures"].size() == 7);
  CHECK(std::abs(answer["distance_error_mm"].get<double>()) < 0.05);

  const TempFolder folder;
  const std::string drifted = (folder / "drifted").string();
  must_run("simulate --scene plate-on-belt --seed 5 --drift-px 0.2" + std::string(kSmallRig) + drifted);
  const Outcome bad = beltpick_run("calibrate verify " + drifted + calibration_option() + kBoard + " --json --report " +
                                   (folder / "report").string());
  INFO(bad.err);
  CHECK(bad.exit_code == 1);
  CHECK(bad.error_lines() == 1);
  CHECK(bad.err.find("out of tolerance") != std::string::npos);
  CHECK(bad.err.find("[CHECK_FAILED]") != std::string::npos);
  CHECK(nlohmann::json::parse(bad.out)["good"] == false);
  const std::string page = file_bytes(folder / "report/index.html");
  CHECK(page.find("out of tolerance") != std::string::npos);
  CHECK(page.find("</html>") != std::string::npos);
  const Outcome wide = beltpick_run("calibrate verify " + drifted + calibration_option() + kBoard + " --plate-mm 5");
  CHECK(wide.exit_code == 0);
}

TEST_CASE("calibrate verify refuses what is no check in one line", "[calibrate]") {
  const std::string capture = (calibrated() / "on_belt").string();
  const std::string verify = "calibrate verify " + capture + calibration_option();
  check_refused(verify, 2, "--board");
  check_refused(verify + " --board 11x8", 2, "--square-mm");
  check_refused(verify + " --board eleven --square-mm 20", 2, "--board");
  check_refused(verify + " --board 9x6 --square-mm 20", 1, "no 9x6 chessboard found");
  check_refused(verify + " --board 11x8 --square-mm 30", 1, "--square-mm");
  check_refused("calibrate verify " + capture + " --calibration " + scene_file("calibration.json") + kBoard, 1,
                "640x480");
  check_refused("calibrate verify " + (bare_belt() / "bare").string() + calibration_option() + kBoard, 1, "both axes");
}

TEST_CASE("calibrate belt takes the belt's frame from the plate on it", "[calibrate]") {
  const TempFolder folder;
  const std::string capture = (calibrated() / "on_belt").string();
  const std::string cell = (folder / "cell.json").string();
  // With the rig's own calibration, whose camera frame is the truth's.
  const std::string belt =
      "calibrate belt " + capture + " --calibration " + capture + "/calibration.json --out " + cell;
  const Outcome outcome = beltpick_run(belt + kBoard + " --plate-thickness-mm 5 --json");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.err.empty());
  CHECK(nlohmann::json::parse(outcome.out)["height_above_belt_mm"].get<double>() == Approx(5.0).margin(0.05));
  const auto found = json_of(cell)["belt_from_camera"];
  const auto plate = json_of(capture + "/truth.json")["plate"];
  // The first inner corner lies 5 mm above the origin, the last of its row 200 mm along x.
  const auto pose = plate["pose_camera"];
  const auto in_belt = [&](double x_mm, double y_mm, int axis) {
    double sum = found[axis][3];
    for (int i = 0; i < 3; ++i) {
      const double in_camera =
          pose[i][0].get<double>() * x_mm + pose[i][1].get<double>() * y_mm + pose[i][3].get<double>();
      sum += found[axis][i].get<double>() * in_camera;
    }
    return sum;
  };
  CHECK(in_belt(0, 0, 0) == Approx(0.0).margin(0.1));
  CHECK(in_belt(0, 0, 1) == Approx(0.0).margin(0.1));
  CHECK(in_belt(0, 0, 2) == Approx(5.0).margin(0.1));
  CHECK(in_belt(200, 0, 0) == Approx(200.0).margin(0.1));
  CHECK(in_belt(0, 140, 1) == Approx(-140.0).margin(0.1));

  const Outcome thick = beltpick_run(belt + kBoard + " --plate-thickness-mm 6");
  CHECK(thick.exit_code == 0);
  CHECK(thick.err.find("its thickness was given as 6.00 mm") != std::string::npos);
  check_refused(belt + kBoard, 2, "--plate-thickness-mm");
  check_refused(belt + " --plate-thickness-mm 5", 2, "--board");
}

TEST_CASE("A calibration is repeated from its observations, with and without one of them", "[calibrate]") {
  const TempFolder folder;
  const std::string resume = "calibrate --resume " + (calibrated() / "calibration.observations.json").string() +
                             " --out " + (folder / "again.json").string();
  const Outcome same = beltpick_run(resume);
  INFO(same.err);
  REQUIRE(same.exit_code == 0);
  CHECK(file_bytes(folder / "again.json") == file_bytes(calibrated() / "calibration.json"));
  const Outcome without = beltpick_run(resume + " --leave-out 003 --json");
  INFO(without.err);
  REQUIRE(without.exit_code == 0);
  const auto answer = nlohmann::json::parse(without.out);
  CHECK(answer["poses_used"] == 7);
  CHECK(without.out.find("left out as asked for") != std::string::npos);
  CHECK(json_of(folder / "again.json")["id"] != json_of(calibrated() / "calibration.json")["id"]);
  check_refused(resume + " --leave-out 099", 2, "'099'");
  check_refused("calibrate stray verify " + (calibrated() / "on_belt").string() + calibration_option() + kBoard, 2,
                "stands before 'verify'");
}

TEST_CASE("The report of a calibration lies where it was asked for", "[calibrate]") {
  const std::string page = file_bytes(calibrated() / "report/index.html");
  CHECK(page.find("Calibration usable: ") != std::string::npos);
  const auto report = json_of(calibrated() / "report/report.json");
  CHECK(report["poses"].size() == 8);
  CHECK(report["held_out"]["rms_mm"].get<double>() < 0.03);
}
