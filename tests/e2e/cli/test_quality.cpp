// `beltpick decode --quality`: the pictures agree with the counts, and every masked pixel has its reason.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "contract_io/file_io.hpp"
#include "contract_io/image_io.hpp"
#include "contract_io/npy_io.hpp"
#include "support/run_program.hpp"
#include "workshop.hpp"

using namespace beltpick;
using namespace beltpick::test;

TEST_CASE("the quality pictures agree with counts, code and points", "[quality]") {
  const TempFolder folder;
  const std::string scene = (workshop() / "scene").string();
  const bool with_calibration = GENERATE(false, true);
  const std::string calibrated =
      with_calibration ? " --calibration " + scene + "/calibration.json --xyz " + (folder / "xyz.npy").string() : "";
  const Outcome outcome = beltpick_run("decode " + scene + calibrated + " --json --quality " +
                                       (folder / "quality").string() + " --code " + (folder / "code.npy").string());
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto answer = nlohmann::json::parse(outcome.out);
  const auto text = contract_io::read_file(folder / "quality/quality.json");
  REQUIRE(text);
  const auto quality = nlohmann::json::parse(*text);
  CHECK(quality["pixels"] == answer["pixels"]);

  int pixels = 0;
  for (const auto& count : quality["pixels"]) pixels += count.get<int>();
  CHECK(pixels == 160 * 120);
  CHECK(quality["pixels"]["edge"].get<int>() > 0);
  const auto code = contract_io::read_npy<float>(folder / "code.npy", {-1, -1, 2});
  REQUIRE(code);
  int coded = 0;
  for (std::size_t i = 0; i < code->values.size(); i += 2) coded += std::isnan(code->values[i]) ? 0 : 1;
  CHECK(coded == quality["pixels"]["valid"].get<int>());
  if (with_calibration) CHECK(answer["points"] == quality["pixels"]["valid"]);

  for (const char* file : {"states.png", "modulation.png", "sigma_px.png", "order.png"}) {
    const auto image = contract_io::read_grey_image(folder / "quality" / file);
    REQUIRE(image);
    CHECK(image->cols == 160);
  }
  CHECK(std::filesystem::exists(folder / "quality/sigma_mm.png") == with_calibration);
  CHECK(contract_io::read_file(folder / "quality/legend.txt")->find("yellow") != std::string::npos);
}
