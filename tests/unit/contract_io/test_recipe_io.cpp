#include <catch2/catch.hpp>

#include <filesystem>

#include "contract/result_codes.hpp"
#include "contract_io/capture_io.hpp"
#include "contract_io/recipe_io.hpp"

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
