#include <catch2/catch.hpp>
#include <cmath>

#include "capture_forms.hpp"
#include "contract_io/npy_io.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

struct Code {
  std::vector<float> values;
  std::string warnings;
};

Code decode(const std::filesystem::path& capture) {
  const TempFolder folder;
  const Outcome outcome = beltpick_run("decode '" + capture.string() + "' --code " + (folder / "code.npy").string());
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto code = contract_io::read_npy<float>(folder / "code.npy", {-1, -1, 2});
  REQUIRE(code);
  return {code->values, outcome.err};
}

bool same(const Code& a, const Code& b) {
  return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                    [](float x, float y) { return (std::isnan(x) && std::isnan(y)) || std::abs(x - y) < 1e-3F; });
}

// 16 bits are summed in floating point: last bits differ, and a pixel at a threshold may fall to either side.
bool nearly_same(const Code& a, const Code& b) {
  std::size_t both = 0;
  std::size_t close = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    if (std::isnan(a.values[i]) && std::isnan(b.values[i])) continue;
    ++both;
    close += std::abs(a.values[i] - b.values[i]) < 0.1F ? 1 : 0;
  }
  return static_cast<double>(close) > 0.99 * static_cast<double>(both);
}

}  // namespace

TEST_CASE("A capture decodes the same in every form", "[forms]") {
  const TempFolder folder;
  REQUIRE(beltpick_run("simulate --camera 160x120 --projector 152x190 --seed 4 --axes both --out " +
                       (folder / "png").string())
              .exit_code == 0);
  const Code expected = decode(folder / "png");
  CHECK(expected.warnings.empty());
  CHECK(std::any_of(expected.values.begin(), expected.values.end(), [](float x) { return x > 100; }));

  CHECK(same(decode(folder / "png/capture.json"), expected));
  REQUIRE(zip_folder(folder / "png", folder / "root.zip", ""));
  CHECK(same(decode(folder / "root.zip"), expected));
  REQUIRE(zip_folder(folder / "png", folder / "nested.zip", "some folder/"));
  CHECK(same(decode(folder / "nested.zip"), expected));

  REQUIRE(convert(folder / "png", folder / "bmp", 255, backwards_bmp));
  const Code paletted = decode(folder / "bmp");
  CHECK(same(paletted, expected));
  CHECK(paletted.warnings.empty());

  REQUIRE(convert(folder / "png", folder / "deep", 65535, deep_png));
  CHECK(nearly_same(decode(folder / "deep"), expected));

  REQUIRE(convert(folder / "png", folder / "colour", 255, colour_png));
  const Code colour = decode(folder / "colour");
  CHECK(same(colour, expected));
  CHECK(std::count(colour.warnings.begin(), colour.warnings.end(), '\n') == 1);
}
