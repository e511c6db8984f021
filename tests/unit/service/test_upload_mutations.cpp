// 100,000 damaged uploads and messages straight into what parses them: taken or refused in one line, never a crash, and
// never memory by what a number in them claims.
#include <zlib.h>

#include <catch2/catch.hpp>
#include <functional>

#include "contract/result_codes.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/json_reader.hpp"
#include "contract_io/recipe_io.hpp"
#include "contract_io/template_io.hpp"
#include "support/mutate.hpp"
#include "support/temp_folder.hpp"
#include "unit/contract_io/samples.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

constexpr int kOfEach = 20'000;
constexpr std::uint64_t kSeed = 20260131;

const char* const kRecipe = R"({"format": "beltpick-recipe", "version": 1, "number": 7, "name": "knuckles",
  "exposure_us": 8000, "settle_us": 1000, "period_us": 25000, "templates": ["knuckle", "hub.template"],
  "sequence": {"projector": {"width": 912, "height": 1140, "layout": "square"}, "frames": [
    {"file": "0.png", "kind": "phase", "axis": "column", "period_px": 18, "steps": 4, "step": 0, "offset_rad": 0.0},
    {"file": "1.png", "kind": "gray", "axis": "column", "cell_px": 9, "bit": 6, "inverted": false},
    {"file": "2.png", "kind": "white"}]}})";

// A plate of 10 mm with a hole, as far as a parser is concerned.
std::string template_bytes(const TempFolder& folder) {
  PartTemplate part;
  part.name = "plate";
  for (int i = 0; i < 40; ++i) {
    part.point_mm.emplace_back(static_cast<float>(i % 8), static_cast<float>(i / 8), 0.0F);
    part.normal.emplace_back(0.0F, 0.0F, 1.0F);
  }
  part.spacing_mm = 1.0;
  part.box_max_mm = Vec3(7, 4, 1);
  part.primitives.emplace_back();
  part.primitives.back().direction = Vec3::UnitZ();
  part.primitives.back().radius_mm = 3;
  part.primitives.back().extent_mm = 5;
  part.symmetry.name = "C2";
  part.symmetry.elements.emplace_back();
  part.grasps.push_back({"across", {}, 12.0});
  const auto path = folder / "plate.template";
  REQUIRE(write_template(path, part));
  return file_bytes(path);
}

// The first line made to fit what follows again, so that damage gets past the checksum.
std::string sealed(const std::string& first_line, const std::string& rest, std::size_t json_bytes) {
  const auto sum = crc32_z(0, reinterpret_cast<const unsigned char*>(rest.data()), rest.size());
  char line[80];
  std::snprintf(line, sizeof line, "%s 1 %08x %zu\n", first_line.c_str(), static_cast<unsigned>(sum), json_bytes);
  return line + rest;
}

int refused_of(const std::string& good, const std::function<Result<void>(const std::string&)>& parse) {
  return torture(good, parse, kOfEach, kSeed);
}

}  // namespace

TEST_CASE("no damaged calibration or cell crashes its parser", "[mutations]") {
  CHECK(refused_of(kCalibrationJson, [](const std::string& text) {
          Warnings warnings;
          return outcome(parse_calibration(text, "calibration", warnings));
        }) > kOfEach / 2);
  CHECK(refused_of(kCellJson, [](const std::string& text) {
          Warnings warnings;
          return outcome(parse_cell(text, "cell", warnings));
        }) > kOfEach / 2);
}

TEST_CASE("no damaged recipe crashes its parser, nor its sequence", "[mutations]") {
  CHECK(refused_of(kRecipe, [](const std::string& text) {
          Warnings warnings;
          const auto recipe = parse_stored_recipe(text, "recipe", "knuckles", warnings);
          if (!recipe) return outcome(recipe);
          return outcome(recipe_sequence(*recipe, {912, 1140}, warnings));
        }) > kOfEach / 3);
}

TEST_CASE("no damaged template crashes its parser, whether its checksum is right or not", "[mutations]") {
  const TempFolder folder;
  const std::string good = template_bytes(folder);
  const std::size_t line = good.find('\n') + 1;
  const std::size_t json_bytes = static_cast<std::size_t>(std::stoul(good.substr(good.rfind(' ', line - 1))));
  const std::string header = good.substr(line, json_bytes), points = good.substr(line + json_bytes);
  const auto parse = [](const std::string& bytes) { return outcome(parse_template(bytes, "plate", "plate.template")); };
  REQUIRE(sealed("beltpick-template", header + points, json_bytes) == good);

  Random random(kSeed);
  int refused = 0;
  for (int i = 0; i < kOfEach; ++i) {
    const std::string json = i % 2 == 0 ? mutate(header, random) : header;
    const std::string rest = json + (i % 2 == 0 ? points : mutate(points, random));
    const auto done = parse(sealed("beltpick-template", rest, json.size()));
    if (done) continue;
    ++refused;
    if (!is_one_line(done.error())) FAIL("not one line: " << done.error().text());
  }
  CHECK(refused > kOfEach / 3);
  Random cheap(kSeed);
  for (int i = 0; i < kOfEach / 10; ++i) (void)parse(mutate(good, cheap));
}

TEST_CASE("no damaged message crashes the reader of messages", "[mutations]") {
  CHECK(refused_of(
            R"({"token": "0123456789abcdef", "name": "anna", "role": "viewer", "version": 3, "flags": [true, 1e3]})",
            [](const std::string& text) {
              Warnings warnings;
              JsonDocument document(text, "request", warnings);
              JsonObject message = document.message();
              (void)message.text("token");
              (void)message.text("name", "nobody");
              (void)message.choice("role", {"viewer", "operator"});
              (void)message.integer("version", {1, 2e9}, 1);
              message.finish();
              if (document.failed()) return Result<void>(document.error());
              return Result<void>{};
            }) > kOfEach / 3);
}
