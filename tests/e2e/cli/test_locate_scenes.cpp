// Scenes in which parts were once missed, from the renderer to the poses, against the truth.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/pose.hpp"
#include "base/units.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

nlohmann::json read_json(const std::filesystem::path& path) { return nlohmann::json::parse(std::ifstream(path)); }

Mat4 matrix_of(const nlohmann::json& rows) {
  Mat4 matrix;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) matrix(row, col) = rows[row][col];
  }
  return matrix;
}

bool close(const Mat4& a, const Mat4& b) {
  const Mat3 turn_a = a.topLeftCorner<3, 3>(), turn_b = b.topLeftCorner<3, 3>();
  return (a - b).topRightCorner<3, 1>().norm() < 1.0 && rotation_between_rad(turn_a, turn_b) < rad_from_deg(1.0);
}

}  // namespace

TEST_CASE("parts that lie on one another without a step between them are all found", "[locate]") {
  const TempFolder folder;
  const std::string scene = (folder / "scene").string(), part = (folder / "knuckle.template").string();
  REQUIRE(
      beltpick_run("simulate --scene paper:11 --seed 31001 --out " + scene + " --write-parts " + folder.path().string())
          .exit_code == 0);
  REQUIRE(beltpick_run("teach " + (folder / "knuckle.stl").string() + " --out " + part).exit_code == 0);
  const Outcome located = beltpick_run("locate " + scene + " --calibration " + scene + "/calibration.json --template " +
                                       part + " --out " + (folder / "result.json").string());
  INFO(located.err);
  REQUIRE(located.exit_code == 0);
  const auto truth = read_json(folder / "scene" / "truth.json");
  const auto result = read_json(folder / "result.json");
  CHECK(result["parts"].size() == truth["parts"].size());
  for (const auto& found : result["parts"]) {
    const Mat4 pose = matrix_of(found["pose_camera"]);
    int fits = 0;
    for (const auto& real : truth["parts"]) fits += close(pose, matrix_of(real["pose_camera"])) ? 1 : 0;
    CHECK(fits == 1);
  }
}
