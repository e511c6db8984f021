#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "contract_io/toml_config.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

constexpr const char* kConfig = R"(# a cell
name = "line 4"
[camera]
exposure_us = 8000
gain = 1.5
mono = true
offsets = [1, 2.5, -3]
[[grasp]]
name = "boss"
[[grasp]]
name = "rim"
[plc]
hosts = ["a", "b"]
)";

}  // namespace

TEST_CASE("Values are found under their dotted keys", "[toml]") {
  auto config = TomlConfig::parse(kConfig, "cell.toml");
  REQUIRE(config);
  CHECK(config->text("name", "") == "line 4");
  CHECK(config->integer("camera.exposure_us", 1) == 8000);
  CHECK(config->number("camera.exposure_us", 1) == 8000.0);
  CHECK(config->number("camera.gain", 1) == 1.5);
  CHECK(config->flag("camera.mono", false));
  CHECK(*config->numbers("camera.offsets", 3) == std::vector<double>{1, 2.5, -3});
  CHECK(config->count("grasp") == 2);
  CHECK(config->text("grasp[0].name", "") == "boss");
  CHECK(config->text("grasp[1].name", "") == "rim");
  CHECK(config->texts("plc.hosts") == std::vector<std::string>{"a", "b"});
  CHECK(config->number("camera.absent", 7.5) == 7.5);
  CHECK_FALSE(config->numbers("camera.absent", 3));
  Warnings warnings;
  CHECK(config->finish(warnings));
  CHECK(warnings.empty());
}

TEST_CASE("Keys nobody asked for warn with their line", "[toml]") {
  auto config = TomlConfig::parse("a = 1\nexpsure = 2\n", "cell.toml");
  REQUIRE(config);
  CHECK(config->integer("a", 0) == 1);
  Warnings warnings;
  CHECK(config->finish(warnings));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0] == "cell.toml: line 2: unknown key 'expsure' is ignored; check its spelling");
}

TEST_CASE("Wrong types and values are named with their line", "[toml]") {
  const auto refused = [](const std::string& text, auto ask, ResultCode code, std::string_view words) {
    auto config = TomlConfig::parse("\n" + text, "cell.toml");
    REQUIRE(config);
    ask(*config);
    Warnings warnings;
    const auto done = config->finish(warnings);
    REQUIRE_FALSE(done);
    INFO(done.error().text());
    CHECK(done.error().code == code);
    CHECK(mentions(done.error(), "cell.toml: line 2: a"));
    CHECK(mentions(done.error(), words));
  };
  refused(
      "a = 'x'", [](auto& c) { c.number("a", 0); }, ResultCode::kFormatInvalid, "a number, found \"x\"");
  refused(
      "a = 1.5", [](auto& c) { c.integer("a", 0); }, ResultCode::kFormatInvalid, "a whole number, found 1.5");
  refused(
      "a = 9", [](auto& c) { c.integer("a", 0, 1, 8); }, ResultCode::kValueOutOfRange, "between 1 and 8, found 9");
  refused(
      "a = nan", [](auto& c) { c.number("a", 0, 1, 8); }, ResultCode::kValueOutOfRange, "nan");
  refused(
      "a = 99999999999", [](auto& c) { c.integer("a", 0); }, ResultCode::kValueOutOfRange, "found 99999999999");
  refused(
      "a = 1", [](auto& c) { c.flag("a", false); }, ResultCode::kFormatInvalid, "true or false");
  refused(
      "a = 1", [](auto& c) { c.text("a", ""); }, ResultCode::kFormatInvalid, "a text in quotes");
  refused(
      "a = 1979-05-27", [](auto& c) { c.number("a", 0); }, ResultCode::kFormatInvalid, "a number");
}

TEST_CASE("Arrays of the wrong length and missing keys are errors", "[toml]") {
  auto config = TomlConfig::parse("a = [1, 2]\n", "cell.toml");
  REQUIRE(config);
  (void)config->numbers("a", 3);
  Warnings warnings;
  const auto length = config->finish(warnings);
  REQUIRE_FALSE(length);
  CHECK(mentions(length.error(), "a: expected an array of 3 numbers, found 2"));

  auto other = TomlConfig::parse("a = 1\n", "cell.toml");
  other->require("camera.address");
  const auto missing = other->finish(warnings);
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ResultCode::kMemberMissing);
  CHECK(mentions(missing.error(), "camera.address"));
}

TEST_CASE("Text that is not TOML is refused with its line", "[toml]") {
  const TempFolder folder;
  const auto config = TomlConfig::read(folder.file("cell.toml", "a = 1\nb = = 2\n"));
  REQUIRE_FALSE(config);
  CHECK(mentions(config.error(), "line 2"));
  CHECK(is_one_line(config.error()));
  CHECK_FALSE(TomlConfig::read(folder / "absent.toml"));
}
