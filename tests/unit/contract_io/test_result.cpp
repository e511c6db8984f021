#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/result_io.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

PartTemplate knuckle() {
  PartTemplate part;
  part.name = "knuckle";
  part.symmetry.name = "C2";
  Grasp grasp;
  grasp.name = "boss";
  grasp.opening_mm = 40;
  grasp.T_part_gripper.translation_mm = {0, 0, 10};
  part.grasps = {grasp};
  return part;
}

LocateReport one_part() {
  LocateReport report;
  report.capture_id = "lap 1";
  report.calibration_id = "c1";
  LocatedPart part;
  part.segment = 1;
  part.T_camera_part.translation_mm = {1, 2, 700};
  part.grasp_index = 0;
  part.rms_mm = 0.07;
  part.covariance(5, 5) = 0.25;
  report.parts = {part};
  WithheldObject object;
  object.segment = 3;
  object.reason = failure(ResultCode::kFreeSpaceViolated, "0.2 of it").error();
  report.withheld = {object};
  report.stage_times = {{Stage::kDecode, 12.5}};
  report.part_times = {{1, 40.0}};
  report.memory = {{"arena", 1000}};
  return report;
}

}  // namespace

TEST_CASE("result.json has the members of the design", "[result]") {
  const std::vector<PartTemplate> templates{knuckle()};
  Cell cell;
  cell.T_belt_camera = Pose<frame::Belt, frame::Camera>{Mat3::Identity(), {0, 0, -700}};
  const auto json = nlohmann::json::parse(result_text(one_part(), templates, cell));
  CHECK(json["format"] == "beltpick-result");
  CHECK(json["version"] == 1);
  CHECK(json["capture_id"] == "lap 1");
  const auto& part = json["parts"][0];
  CHECK(part["part"] == "knuckle");
  CHECK(part["status"] == "verified");
  CHECK(part["pose_camera"][2][3] == 700);
  CHECK(part["pose_camera"][3] == nlohmann::json{0, 0, 0, 1});
  CHECK(part["pose_belt"][2][3] == 0);
  CHECK_FALSE(part.contains("pose_robot"));
  CHECK(part["grasp"]["name"] == "boss");
  CHECK(part["grasp"]["pose_camera"][2][3] == 710);
  CHECK(part["symmetry"] == "C2");
  CHECK(part["covariance"].size() == 6);
  CHECK(part["covariance"][5][5] == 0.25);
  CHECK(json["withheld"][0] ==
        nlohmann::json{{"segment", 3}, {"stage", "verify"}, {"code", "FREE_SPACE_VIOLATED"}, {"detail", "0.2 of it"}});
  CHECK(json["timing_ms"]["decode"] == 12.5);
  CHECK(json["timing_ms"]["parts"][0]["total"] == 40.0);
  CHECK(json["memory"]["arena"] == 1000);
}

TEST_CASE("An empty result has empty lists", "[result]") {
  const auto json = nlohmann::json::parse(result_text({}, {}, {}));
  CHECK(json["parts"] == nlohmann::json::array());
  CHECK(json["withheld"] == nlohmann::json::array());
  CHECK(json["calibration_id"].is_null());
}

TEST_CASE("A result is written whole or not at all", "[result]") {
  const TempFolder folder;
  const std::vector<PartTemplate> templates{knuckle()};
  REQUIRE(write_result(folder / "result.json", one_part(), templates, {}));
  CHECK(nlohmann::json::parse(file_bytes(folder / "result.json"))["parts"].size() == 1);
  const auto refused = write_result(folder / "no/such/folder/result.json", one_part(), templates, {});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ResultCode::kFileNotWritten);
}
