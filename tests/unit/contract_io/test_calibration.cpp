#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

// The sample with the value at a JSON pointer replaced.
std::string with(const char* sample, const char* pointer, const nlohmann::json& value) {
  nlohmann::json json = nlohmann::json::parse(sample);
  json[nlohmann::json::json_pointer(pointer)] = value;
  return json.dump();
}

void refused(const std::string& text, ResultCode code, std::string_view words) {
  Warnings warnings;
  const auto calibration = parse_calibration(text, "calibration.json", warnings);
  REQUIRE_FALSE(calibration);
  INFO(calibration.error().text());
  CHECK(calibration.error().code == code);
  CHECK(mentions(calibration.error(), "calibration.json: "));
  CHECK(mentions(calibration.error(), words));
  CHECK(is_one_line(calibration.error()));
}

}  // namespace

TEST_CASE("A calibration is read as it stands", "[calibration]") {
  Warnings warnings;
  const auto calibration = parse_calibration(kCalibrationJson, "c", warnings);
  REQUIRE(calibration);
  CHECK(warnings.empty());
  CHECK(calibration->id == "c1");
  CHECK(calibration->camera_serial == "A7");
  CHECK(calibration->camera.fy_px == 2001);
  CHECK(calibration->camera.distortion[4] == 0.03);
  CHECK(calibration->projector.height == 1140);
  CHECK(calibration->T_projector_camera.translation_mm == Vec3(-350, 0, 90));
  CHECK(calibration->T_projector_camera.rotation(0, 2) == Approx(0.5));
  const Mat3 product = calibration->T_projector_camera.rotation * calibration->T_projector_camera.rotation.transpose();
  CHECK((product - Mat3::Identity()).norm() < 1e-12);
}

TEST_CASE("A calibration reads back as written", "[calibration]") {
  const TempFolder folder;
  Warnings warnings;
  const auto calibration = parse_calibration(kCalibrationJson, "c", warnings);
  REQUIRE(calibration);
  REQUIRE(write_calibration(folder / "c.json", *calibration));
  const auto back = read_calibration(folder / "c.json", warnings);
  REQUIRE(back);
  CHECK(back->camera.distortion == calibration->camera.distortion);
  CHECK(back->projector.cx_px == calibration->projector.cx_px);
  CHECK((back->T_projector_camera.rotation - calibration->T_projector_camera.rotation).norm() < 1e-15);
  CHECK(warnings.empty());
}

TEST_CASE("What no calibration can be is refused, by member", "[calibration]") {
  refused(with(kCalibrationJson, "/camera/matrix/0/0", -2000), ResultCode::kValueOutOfRange, "camera.matrix");
  refused(with(kCalibrationJson, "/camera/matrix/0/1", 3), ResultCode::kValueOutOfRange, "camera.matrix");
  refused(with(kCalibrationJson, "/camera/width", 0), ResultCode::kValueOutOfRange, "camera.width");
  refused(with(kCalibrationJson, "/camera/width", "wide"), ResultCode::kFormatInvalid, "found \"wide\"");
  refused(with(kCalibrationJson, "/camera/width", 12.5), ResultCode::kFormatInvalid, "whole number");
  refused(with(kCalibrationJson, "/projector/distortion", {1, 2, 3, 4}), ResultCode::kFormatInvalid,
          "projector.distortion");
  refused(with(kCalibrationJson, "/projector_from_camera/rotation/0/0", 0.9), ResultCode::kValueOutOfRange, "rotation");
  refused(with(kCalibrationJson, "/projector_from_camera/rotation/1/1", -1), ResultCode::kValueOutOfRange,
          "determinant -1");
  refused(with(kCalibrationJson, "/projector_from_camera/translation", {0, 0, 0}), ResultCode::kValueOutOfRange,
          "baseline");
  refused(with(kCalibrationJson, "/projector", 3), ResultCode::kFormatInvalid,
          "projector: expected an object, found 3");
  refused(with(kCalibrationJson, "/format", "beltpick-cell"), ResultCode::kValueOutOfRange, "format");
  refused(with(kCalibrationJson, "/version", 2), ResultCode::kVersionUnsupported, "expected 1, found 2");
  refused("[]", ResultCode::kFormatInvalid, "a JSON object");
  refused("", ResultCode::kFormatInvalid, "found nothing");
  refused("{\"a\":\n1,}", ResultCode::kFormatInvalid, "line 2");
  refused(std::string(kCalibrationJson).substr(0, 200), ResultCode::kFormatInvalid, "cut off");
  refused(with(kCalibrationJson, "/camera/matrix/0/0", nullptr), ResultCode::kFormatInvalid, "camera.matrix");
}

TEST_CASE("Nesting of any depth is refused, not followed", "[calibration]") {
  const std::string deep = std::string(300'000, '[') + std::string(300'000, ']');
  refused(deep, ResultCode::kFormatInvalid, "an array of 1");
  refused("{\"format\": " + deep + "}", ResultCode::kValueOutOfRange, "format");
  refused(std::string(300'000, '['), ResultCode::kFormatInvalid, "cut off");
  const std::string objects = std::string("{\"format\": ") + "{\"a\": [" + deep + "]}}";
  refused(objects, ResultCode::kValueOutOfRange, "found an object");
}

TEST_CASE("Every required member is missed by name", "[calibration]") {
  for (const char* member : {"camera", "projector", "projector_from_camera"}) {
    nlohmann::json json = nlohmann::json::parse(kCalibrationJson);
    json.erase(member);
    refused(json.dump(), ResultCode::kMemberMissing, std::string(member) + ": expected an object");
  }
  for (const char* member : {"width", "height", "matrix", "distortion"}) {
    nlohmann::json json = nlohmann::json::parse(kCalibrationJson);
    json["camera"].erase(member);
    refused(json.dump(), ResultCode::kMemberMissing, std::string("camera.") + member);
  }
}

TEST_CASE("Unknown members warn with their path", "[calibration]") {
  Warnings warnings;
  REQUIRE(parse_calibration(with(kCalibrationJson, "/camera/skew", 0), "c.json", warnings));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("camera.skew") != std::string::npos);
}

TEST_CASE("A cell file gives the poses it has", "[calibration]") {
  Warnings warnings;
  const auto cell = parse_cell(kCellJson, "cell.json", warnings);
  REQUIRE(cell);
  CHECK(cell->calibration_id == "c1");
  REQUIRE(cell->T_belt_camera);
  CHECK((*cell->T_belt_camera * Vec3(0, 0, 700)).isApprox(Vec3(10, 20, 0)));
  nlohmann::json json = nlohmann::json::parse(kCellJson);
  json.erase("robot_from_camera");
  const auto without_robot = parse_cell(json.dump(), "cell.json", warnings);
  REQUIRE(without_robot);
  CHECK_FALSE(without_robot->T_robot_camera);
  const auto mirrored = parse_cell(with(kCellJson, "/belt_from_camera/0/0", -1), "cell.json", warnings);
  REQUIRE_FALSE(mirrored);
  CHECK(mentions(mirrored.error(), "belt_from_camera"));
  CHECK_FALSE(parse_cell(with(kCellJson, "/belt_from_camera/3/0", 1), "cell.json", warnings));

  const TempFolder folder;
  REQUIRE(write_cell(folder / "cell.json", *cell));
  const auto back = read_cell(folder / "cell.json", warnings);
  REQUIRE(back);
  CHECK(back->T_robot_camera->translation_mm == cell->T_robot_camera->translation_mm);
  CHECK(warnings.empty());
}

TEST_CASE("A cell file that is brought up to date keeps what it is not told", "[calibration]") {
  const TempFolder folder;
  Cell belt_only;
  belt_only.calibration_id = "c2";
  belt_only.T_belt_camera.emplace();
  REQUIRE(update_cell(folder / "new.json", belt_only));
  Warnings warnings;
  REQUIRE(read_cell(folder / "new.json", warnings));
  nlohmann::json json = nlohmann::json::parse(kCellJson);
  json["gripper"] = {{"stroke_mm", 40}};
  const auto path = folder.file("cell.json", json.dump());
  REQUIRE(update_cell(path, belt_only));
  const nlohmann::json updated = nlohmann::json::parse(test::file_bytes(path));
  CHECK(updated["calibration_id"] == "c2");
  CHECK(updated["gripper"]["stroke_mm"] == 40);
  CHECK(updated["robot_from_camera"] == json["robot_from_camera"]);
  CHECK(updated["belt_from_camera"][2][2] == 1.0);

  const auto broken = folder.file("broken.json", "{\"format\": \"beltpick-cell\"");
  REQUIRE_FALSE(update_cell(broken, belt_only));
  CHECK(test::file_bytes(broken) == "{\"format\": \"beltpick-cell\"");
}
