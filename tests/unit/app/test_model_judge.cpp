#include <catch2/catch.hpp>
#include <functional>

#include "app/kept_models.hpp"
#include "app/model_judge.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "small_cell.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

// A judge over the store of a small cell, in which recipe 1 is active.
struct Court : SmallCell {
  std::vector<std::string> warnings;
  std::unique_ptr<KeptModels> kept;
  std::string serial;

  Court() {
    settings.state = "state";
    kept = std::move(*KeptModels::open(settings, warnings));
    warnings.clear();
  }
  [[nodiscard]] ModelJudge judge() const { return {kept->source(), settings, {1, serial}}; }
  ResultCode code(ItemKind kind, const std::string& name, const std::string& bytes) {
    const auto judged = judge().judge(item_id(kind, name), bytes, warnings);
    return judged ? ResultCode::kOk : judged.error().code;
  }
  ResultCode code_of(ItemKind kind, const std::string& name, const std::string& file) {
    return code(kind, name, *contract_io::read_file(folder / file));
  }
  ResultCode removal(ItemKind kind, const std::string& name) const {
    const auto judged = judge().judge_removal(item_id(kind, name));
    return judged ? ResultCode::kOk : judged.error().code;
  }
  ResultCode calibration(const std::function<void(Calibration&)>& change) {
    auto calibration = *contract_io::read_calibration(folder / "calibration.json", warnings);
    change(calibration);
    REQUIRE(contract_io::write_calibration(folder / "other.json", calibration));
    return code_of(ItemKind::kCalibration, "", "other.json");
  }
  static std::string recipe(int number, const std::string& part, const std::string& sequence = "\"fast\"") {
    return R"({"format": "beltpick-recipe", "version": 1, "number": )" + std::to_string(number) +
           R"(, "exposure_us": 5000, "sequence": )" + sequence + R"(, "templates": [")" + part + "\"]}";
  }
};

const std::string kOwnSequence = R"({"projector": {"width": 912, "height": 1140}, "frames": [
  {"file": "0.png", "kind": "white"}, {"file": "1.png", "kind": "black"}]})";

}  // namespace

TEST_CASE("what the cell works with already is good", "[judge]") {
  Court court;
  CHECK(court.code_of(ItemKind::kCalibration, "", "calibration.json") == ResultCode::kOk);
  CHECK(court.code_of(ItemKind::kTemplate, "one", "one.template") == ResultCode::kOk);
  CHECK(court.code(ItemKind::kRecipe, "first", Court::recipe(1, "two")) == ResultCode::kOk);
  CHECK(court.warnings.empty());
}

TEST_CASE("a calibration of another camera, projector or world is refused", "[judge]") {
  Court court;
  CHECK(court.calibration([](Calibration& c) { c.camera.width = 128; }) == ResultCode::kCalibrationMismatch);
  court.serial = "CAM9";
  CHECK(court.calibration([](Calibration&) {}) == ResultCode::kCalibrationMismatch);
  court.serial = "CAM1";
  CHECK(court.calibration([](Calibration&) {}) == ResultCode::kOk);
  CHECK(court.calibration([](Calibration& c) { c.camera.fx_px = 0.5; }) == ResultCode::kValueOutOfRange);
  CHECK(court.calibration([](Calibration& c) { c.projector.cx_px = 1e6; }) == ResultCode::kValueOutOfRange);
  CHECK(court.calibration([](Calibration& c) { c.T_projector_camera.translation_mm /= 1000; }) ==
        ResultCode::kValueOutOfRange);
  CHECK(court.code(ItemKind::kCalibration, "", "{") == ResultCode::kFormatInvalid);
}

TEST_CASE("a calibration for which the cell file must be made anew is taken, with a warning", "[judge]") {
  Court court;
  CHECK(court.calibration([](Calibration& c) { c.id = "newer"; }) == ResultCode::kOk);
  REQUIRE(court.warnings.size() == 1);
  CHECK(court.warnings[0].find("until a cell file of this calibration is uploaded") != std::string::npos);
}

TEST_CASE("the active recipe's own sequence tells which projector a calibration must be of", "[judge]") {
  Court court;
  REQUIRE(court.kept->store().put(item_id(ItemKind::kRecipe, "first"), Court::recipe(1, "one", kOwnSequence), "test"));
  CHECK(court.calibration([](Calibration&) {}) == ResultCode::kCalibrationMismatch);
  // That of a recipe that is not active only warns.
  REQUIRE(court.kept->store().put(item_id(ItemKind::kRecipe, "first"), Court::recipe(1, "one"), "test"));
  REQUIRE(court.kept->store().put(item_id(ItemKind::kRecipe, "second"), Court::recipe(2, "one", kOwnSequence), "test"));
  CHECK(court.calibration([](Calibration&) {}) == ResultCode::kOk);
  REQUIRE(court.warnings.size() == 1);
  CHECK(court.warnings[0].find("recipe 'second'") != std::string::npos);
}

TEST_CASE("a cell file is of this calibration and of this world", "[judge]") {
  Court court;
  Cell cell;
  cell.calibration_id = "elsewhere";
  REQUIRE(contract_io::write_cell(court.folder / "other.json", cell));
  CHECK(court.code_of(ItemKind::kCell, "", "other.json") == ResultCode::kCalibrationMismatch);
  cell.calibration_id = "small";
  cell.T_robot_camera.emplace().translation_mm = {0, 50'000, 0};
  REQUIRE(contract_io::write_cell(court.folder / "other.json", cell));
  CHECK(court.code_of(ItemKind::kCell, "", "other.json") == ResultCode::kValueOutOfRange);
  cell.T_robot_camera->translation_mm = {0, 500, 0};
  REQUIRE(contract_io::write_cell(court.folder / "other.json", cell));
  CHECK(court.code_of(ItemKind::kCell, "", "other.json") == ResultCode::kOk);
}

TEST_CASE("a recipe has a number of its own, templates that are there, frames that fit", "[judge]") {
  Court court;
  CHECK(court.code(ItemKind::kRecipe, "third", Court::recipe(2, "one")) == ResultCode::kValueOutOfRange);
  CHECK(court.code(ItemKind::kRecipe, "third", Court::recipe(3, "one")) == ResultCode::kOk);
  CHECK(court.code(ItemKind::kRecipe, "third", Court::recipe(3, "nothing")) == ResultCode::kNoTemplate);
  CHECK(court.code(ItemKind::kRecipe, "third", Court::recipe(3, "one", "\"mine.json\"")) ==
        ResultCode::kValueOutOfRange);
  CHECK(court.code(ItemKind::kRecipe, "third", Court::recipe(3, "one", kOwnSequence)) ==
        ResultCode::kCalibrationMismatch);
  CHECK(court.code(ItemKind::kRecipe, "first", Court::recipe(3, "one")) == ResultCode::kItemInUse);
  court.settings.limits.frames = 4;
  CHECK(court.code(ItemKind::kRecipe, "third", Court::recipe(3, "one")) == ResultCode::kLimitExceeded);
}

TEST_CASE("a template is whole, of a part, and within the limits", "[judge]") {
  Court court;
  std::string bytes = *contract_io::read_file(court.folder / "one.template");
  bytes[bytes.size() / 2] ^= 1;
  CHECK(court.code(ItemKind::kTemplate, "one", bytes) == ResultCode::kChecksumWrong);
  CHECK(court.code(ItemKind::kTemplate, "one", "solid") == ResultCode::kFormatInvalid);
  court.settings.limits.template_points = 1000;
  CHECK(court.code_of(ItemKind::kTemplate, "one", "one.template") == ResultCode::kOk);
  CHECK(court.code_of(ItemKind::kTemplate, "two", "two.template") == ResultCode::kTemplateTooLarge);

  auto part = *contract_io::read_template(court.folder / "one.template");
  const auto code_of_part = [&] {
    REQUIRE(contract_io::write_template(court.folder / "odd.template", part));
    return court.code_of(ItemKind::kTemplate, "one", "odd.template");
  };
  CHECK(code_of_part() == ResultCode::kOk);
  std::swap(part.box_min_mm, part.box_max_mm);
  CHECK(code_of_part() == ResultCode::kValueOutOfRange);
  std::swap(part.box_min_mm, part.box_max_mm);
  part.spacing_mm = 0.0;
  CHECK(code_of_part() == ResultCode::kValueOutOfRange);
  part.spacing_mm = 2.0;
  part.grasps.front().T_part_gripper.rotation *= 2.0;
  CHECK(code_of_part() == ResultCode::kValueOutOfRange);
}

TEST_CASE("what the cell needs cannot be removed", "[judge]") {
  Court court;
  CHECK(court.removal(ItemKind::kCalibration, "") == ResultCode::kItemInUse);
  CHECK(court.removal(ItemKind::kTemplate, "two") == ResultCode::kItemInUse);  // of a recipe that is not active
  CHECK(court.removal(ItemKind::kRecipe, "first") == ResultCode::kItemInUse);
  CHECK(court.removal(ItemKind::kRecipe, "second") == ResultCode::kOk);
  REQUIRE(court.kept->store().remove(item_id(ItemKind::kRecipe, "second"), "test"));
  CHECK(court.removal(ItemKind::kTemplate, "two") == ResultCode::kOk);
}

TEST_CASE("before there is a calibration, recipes and cell are taken with a warning", "[judge]") {
  Court court;
  std::filesystem::remove(court.folder / "calibration.json");
  court.settings.state = "other_state";
  const auto empty = KeptModels::open(court.settings, court.warnings);
  REQUIRE(empty);
  court.warnings.clear();
  const ModelJudge judge((*empty)->source(), court.settings, {});
  CHECK(judge.judge(item_id(ItemKind::kRecipe, "third"), Court::recipe(3, "one"), court.warnings));
  CHECK(court.warnings.size() == 1);
  CHECK_FALSE(judge.judge(item_id(ItemKind::kRecipe, "third"), Court::recipe(3, "nothing"), court.warnings));
}
