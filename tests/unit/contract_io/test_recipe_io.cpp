#include <catch2/catch.hpp>

#include <filesystem>

#include "contract/result_codes.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/recipe_io.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;

namespace {

const std::string kGood = R"({"format": "beltpick-recipe", "version": 1, "number": 7, "exposure_us": 8000,
  "period_us": 20000, "templates": ["knuckle.template", "/abs/hub.template"]})";

Result<Recipe> parse(const std::string& text) {
  Warnings warnings;
  return parse_recipe(text, "cells/seven.json", "/cells", warnings);
}

std::string without(const std::string& member, const std::string& instead = "") {
  std::string text = kGood;
  const auto at = text.find("\"" + member + "\"");
  text.replace(at, text.find_first_of(",}", at) - at + 1, instead.empty() ? "" : instead + ",");
  return text;
}

}  // namespace

TEST_CASE("a recipe reads with its defaults, its name and its paths", "[recipe]") {
  const auto recipe = parse(kGood);
  REQUIRE(recipe);
  CHECK(recipe->number == 7);
  CHECK(recipe->name == "seven");
  CHECK(recipe->sequence == "standard");
  CHECK(recipe->settle_us == 1000.0);
  CHECK(recipe->templates == std::vector<std::string>{"/cells/knuckle.template", "/abs/hub.template"});
}

TEST_CASE("a recipe of several exposures repeats its sequence", "[recipe]") {
  const auto recipe = parse(without("period_us", "\"exposures_us\": [2000, 12000]"));
  REQUIRE(recipe);
  const ProjectorGrid grid{912, 1140};
  Warnings warnings;
  const auto sequence = recipe_sequence(*recipe, grid, warnings);
  REQUIRE(sequence);
  const auto once = make_sequence(SequenceName::kStandard, grid, SequenceAxes::kColumn);
  REQUIRE(once);
  CHECK(sequence->frames.size() == 2 * once->frames.size());
  CHECK(sequence->frames.front().exposure_us == 2000.0);
  CHECK(sequence->frames.back().exposure_us == 12000.0);
  const auto again = parse(recipe_text(*recipe));
  REQUIRE(again);
  CHECK(again->exposures_us == recipe->exposures_us);

  CHECK(parse(without("period_us", "\"exposures_us\": [2000, \"long\"]")).error().code == ResultCode::kFormatInvalid);
  CHECK(parse(without("period_us", "\"exposures_us\": [2000, 0]")).error().code == ResultCode::kValueOutOfRange);
  const auto twice = parse(without("period_us", "\"exposures_us\": [2000, 2000]"));
  REQUIRE(twice);
  CHECK_FALSE(recipe_sequence(*twice, grid, warnings));
}

TEST_CASE("a wrong recipe is told by member", "[recipe]") {
  for (const std::string member : {"number", "exposure_us"}) {
    const auto missing = parse(without(member));
    REQUIRE_FALSE(missing);
    CHECK(missing.error().code == ResultCode::kMemberMissing);
    CHECK(missing.error().text().find(member) != std::string_view::npos);
  }
  CHECK(parse(without("number", "\"number\": 0")).error().code == ResultCode::kValueOutOfRange);
  const auto short_period = parse(without("period_us", "\"period_us\": 8500"));
  REQUIRE_FALSE(short_period);
  CHECK(short_period.error().text().find("period_us") != std::string_view::npos);
  CHECK_FALSE(parse(R"({"format": "beltpick-recipe", "version": 1, "number": 1, "exposure_us": 1, "period_us": 9000,
    "templates": []})"));
  CHECK_FALSE(parse(R"({"format": "beltpick-recipe", "version": 1, "number": 1, "exposure_us": 1, "period_us": 9000,
    "templates": [3]})"));
  CHECK(parse("{").error().code == ResultCode::kFormatInvalid);
}

TEST_CASE("a written recipe reads back", "[recipe]") {
  const auto path = std::filesystem::temp_directory_path() / "beltpick_recipe_test.json";
  auto recipe = *parse(kGood);
  recipe.axes = SequenceAxes::kBoth;
  recipe.sequence = "robust";
  REQUIRE(write_recipe(path, recipe));
  Warnings warnings;
  const auto back = read_recipe(path, warnings);
  std::filesystem::remove(path);
  REQUIRE(back);
  CHECK(warnings.empty());
  CHECK(back->axes == SequenceAxes::kBoth);
  CHECK(back->sequence == "robust");
  CHECK(back->templates == recipe.templates);
}

TEST_CASE("a recipe's frames have their exposures; a sequence of another projector is refused", "[recipe]") {
  Warnings warnings;
  auto recipe = *parse(kGood);
  const auto sequence = recipe_sequence(recipe, {912, 1140}, warnings);
  REQUIRE(sequence);
  for (const FrameSpec& frame : sequence->frames) CHECK(frame.exposure_us == 8000.0);

  const auto path = std::filesystem::temp_directory_path() / "beltpick_recipe_sequence.json";
  REQUIRE(write_sequence(path, *sequence));
  recipe.sequence = path.string();
  CHECK(recipe_sequence(recipe, {912, 1140}, warnings));
  const auto other = recipe_sequence(recipe, {1280, 800}, warnings);
  std::filesystem::remove(path);
  REQUIRE_FALSE(other);
  CHECK(other.error().code == ResultCode::kCalibrationMismatch);
}

TEST_CASE("a sequence may stand in the recipe itself", "[recipe]") {
  const std::string own = R"("sequence": {"projector": {"width": 100, "height": 80}, "frames": [
    {"file": "0.png", "kind": "gray", "axis": "column", "cell_px": 50, "bit": 0, "exposure_us": 3000},
    {"file": "1.png", "kind": "white"}]}, "exposure_us": 8000)";
  std::string text = kGood;
  text.replace(text.find("\"exposure_us\": 8000"), 19, own);
  Warnings warnings;
  const auto recipe = parse_recipe(text, "seven.json", "/cells", warnings);
  INFO((recipe ? "" : recipe.error().detail));
  REQUIRE(recipe);
  CHECK(warnings.empty());
  REQUIRE(recipe->own_sequence);
  const auto frames = recipe_sequence(*recipe, {100, 80}, warnings);
  REQUIRE(frames);
  CHECK(frames->frames[0].exposure_us == 3000.0);
  CHECK(frames->frames[1].exposure_us == 8000.0);
  CHECK(recipe_sequence(*recipe, {912, 1140}, warnings).error().code == ResultCode::kCalibrationMismatch);

  // Written and read back it is the same.
  const auto back = parse_recipe(recipe_text(*recipe), "seven.json", "/cells", warnings);
  REQUIRE(back);
  REQUIRE(back->own_sequence);
  CHECK(back->own_sequence->frames.size() == 2);
  CHECK(back->own_sequence->frames[0].cell_px == 50.0);

  text.replace(text.find("\"bit\": 0"), 8, "\"bit\": 99");
  const auto wrong = parse_recipe(text, "seven.json", "/cells", warnings);
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().text().find("sequence.frames[0].bit") != std::string_view::npos);
}

TEST_CASE("a recipe that the appliance keeps names its templates and no files", "[recipe]") {
  Warnings warnings;
  const auto stored = [&](const std::string& sequence, const std::string& part) {
    return parse_stored_recipe(R"({"format": "beltpick-recipe", "version": 1, "number": 7, "exposure_us": 8000,
      "sequence": ")" + sequence + R"(", "templates": [")" +
                                   part + "\"]}",
                               "recipe seven", "seven", warnings);
  };
  CHECK(stored("fast", "knuckle.template")->templates == std::vector<std::string>{"knuckle"});
  CHECK(stored("fast", "knuckle")->templates == std::vector<std::string>{"knuckle"});
  CHECK(stored("fast", "parts/knuckle.template").error().code == ResultCode::kValueOutOfRange);
  CHECK(stored("fast", "").error().code == ResultCode::kValueOutOfRange);
  const auto path = stored("sequence.json", "knuckle");
  REQUIRE_FALSE(path);
  CHECK(path.error().text().find("beltpick upload recipe") != std::string_view::npos);
}

TEST_CASE("a recipe file becomes portable with its sequence inside and its templates by name", "[recipe]") {
  const test::TempFolder folder;
  Warnings warnings;
  REQUIRE(write_sequence(folder / "sequence.json",
                         *make_sequence(SequenceName::kFast, {912, 1140}, SequenceAxes::kColumn)));
  const auto file =
      folder.file("r.json", R"({"format": "beltpick-recipe", "version": 1, "number": 7, "exposure_us": 8000,
    "sequence": "sequence.json", "templates": ["parts/knuckle.template", "hub.template"]})");
  const auto portable = portable_recipe(file, warnings);
  INFO((portable ? "" : portable.error().detail));
  REQUIRE(portable);
  REQUIRE(portable->templates.size() == 2);
  CHECK(portable->templates[0].name == "knuckle");
  CHECK(portable->templates[0].path == folder / "parts/knuckle.template");
  const auto stored = parse_stored_recipe(portable->text, "recipe", "other", warnings);
  REQUIRE(stored);
  CHECK(stored->name == "r");
  CHECK(stored->templates == std::vector<std::string>{"knuckle", "hub"});
  CHECK(recipe_sequence(*stored, {912, 1140}, warnings)->frames.size() == 12);

  const auto twins = folder.file("t.json", R"({"format": "beltpick-recipe", "version": 1, "number": 7,
    "exposure_us": 8000, "templates": ["a/knuckle.template", "b/knuckle.template"]})");
  CHECK(portable_recipe(twins, warnings).error().code == ResultCode::kValueOutOfRange);
}
