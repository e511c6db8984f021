#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "contract/capture.hpp"
#include "contract_io/capture_io.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
using namespace beltpick::test;

TEST_CASE("patterns writes the images that sequence.json describes", "[patterns]") {
  const TempFolder folder;
  const Outcome outcome =
      beltpick_run("patterns --projector 200x150 --axes both --out '" + (folder / "my patterns").string() + "'");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.err.empty());
  const auto json = nlohmann::json::parse(file_bytes(folder / "my patterns/sequence.json"));
  CHECK(json["projector"]["width"] == 200);
  REQUIRE(json["frames"].size() > 10);
  contract_io::Warnings warnings;
  auto reader = contract_io::CaptureReader::open(folder / "my patterns", warnings);
  REQUIRE(reader);
  for (int i = 0; i < reader->frames(); ++i) {
    const auto& frame = json["frames"][static_cast<std::size_t>(i)];
    const auto image = reader->image(i, warnings);
    REQUIRE(image);
    REQUIRE(image->cols == 200);
    const int row = 20;
    const int column = 31;
    const int x = frame["axis"] == "row" ? row : column;
    // The design's formula, from the file's own members.
    double expected = 0;
    if (frame["kind"] == "phase") {
      expected = 127.5 + 127.5 * std::cos(2 * M_PI * x / frame["period_px"].get<double>() +
                                          2 * M_PI * frame["step"].get<int>() / frame["steps"].get<int>());
    } else {
      const int cell = static_cast<int>(std::floor((x + 0.5) / frame["cell_px"].get<double>()));
      expected = (((cell ^ (cell >> 1)) >> frame["bit"].get<int>()) & 1) != 0 ? 255 : 0;
    }
    CHECK(std::abs(image->view8()(row, column) - expected) <= 0.5 + 1e-9);
  }
}

TEST_CASE("Every named sequence and layout is written, with JSON and an explanation", "[patterns]") {
  const TempFolder folder;
  for (const char* name : {"fast", "standard", "robust"}) {
    const Outcome outcome = beltpick_run("patterns --projector 64x48 --layout diamond --json --sequence " +
                                         std::string(name) + " --out " + (folder / name).string());
    REQUIRE(outcome.exit_code == 0);
    const auto answer = nlohmann::json::parse(outcome.out);
    const auto sequence = nlohmann::json::parse(file_bytes(folder / name / "sequence.json"));
    CHECK(answer["frames"] == sequence["frames"].size());
    CHECK(sequence["projector"]["layout"] == "diamond");
  }
  const Outcome outcome = beltpick_run("patterns --projector 64x48 --explain --out " + (folder / "e").string());
  CHECK(outcome.out.find("000.png  phase  column") != std::string::npos);
}

TEST_CASE("patterns explains any sequence before anything is captured", "[patterns]") {
  const TempFolder folder;
  const auto explained = [&](const std::string& arguments) {
    const Outcome outcome = beltpick_run("patterns --explain --json " + arguments);
    INFO(arguments << ": " << outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return nlohmann::json::parse(outcome.out);
  };
  const auto standard = explained("--projector 912x1140 --axes both --projector-hz 120 --exposure-us 4000");
  CHECK(standard["frames"] == 32);
  CHECK(standard["explain"]["time_ms"].get<double>() == Approx(32 * 1000.0 / 120.0));
  CHECK(standard["explain"]["axes"].size() == 2);
  CHECK(standard["explain"]["decoder_bytes_per_pixel"].get<int>() > 8);
  const auto sigma_mm = [](const nlohmann::json& answer) {
    return answer["explain"]["axes"][0]["noise"][0]["sigma_mm"].get<double>();
  };
  CHECK(sigma_mm(standard) < 0.022);
  // Columns tell the depth, rows nearly nothing: camera and projector stand side by side.
  CHECK(standard["explain"]["axes"][1]["mm_per_px"] > 10.0 * standard["explain"]["axes"][0]["mm_per_px"].get<double>());
  const auto fast = explained("--projector 912x1140 --sequence fast --exposure-us 20000");
  CHECK(fast["explain"]["time_ms"].get<double>() == Approx(12 * 20.0));  // the camera is the slower one
  CHECK(sigma_mm(fast) > 1.3 * sigma_mm(standard));
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
  // The same frames from a file, written or not.
  REQUIRE(beltpick_run("patterns --projector 912x1140 --sequence fast --out " + (folder / "fast").string()).exit_code ==
          0);
  const std::string file = (folder / "fast/sequence.json").string();
  CHECK(sigma_mm(explained("--sequence " + file)) == Approx(sigma_mm(fast)));
  CHECK(explained("--sequence " + file + " --out " + (folder / "again").string())["frames"] == 12);
  CHECK(file_bytes(folder / "again/003.png") == file_bytes(folder / "fast/003.png"));
  const Outcome other = beltpick_run("patterns --explain --projector 640x480 --sequence " + file);
  CHECK(other.exit_code != 0);
  CHECK(other.error_lines() == 1);
}

TEST_CASE("patterns for a LightCrafter 4500 tells planes, images and load time to a person", "[patterns]") {
  const TempFolder folder;
  const Outcome fast = beltpick_run("patterns --lcr4500 --sequence fast --explain --out " + (folder / "fast").string());
  INFO(fast.out << fast.err);
  REQUIRE(fast.exit_code == 0);
  CHECK(fast.out.find("47 bit planes in 2 images") != std::string::npos);
  CHECK(fast.out.find("no load time") != std::string::npos);
  CHECK(fast.out.find("in flash_1.bmp B6") != std::string::npos);
  const Outcome standard =
      beltpick_run("patterns --lcr4500 --projector 912x1140 --layout diamond --out " + (folder / "standard").string());
  CHECK(standard.out.find("72 bit planes in 3 images") != std::string::npos);
  CHECK(standard.out.find("1 image is loaded during every capture, up to 200 ms") != std::string::npos);
  contract_io::Warnings warnings;
  const auto sequence = contract_io::read_sequence(folder / "standard/sequence.json", warnings);
  REQUIRE(sequence);
  CHECK(warnings.empty());
  REQUIRE(sequence->flash.size() == sequence->frames.size());
  CHECK(sequence->flash.back() == FlashPlace{2, 23, 1});
}

TEST_CASE("patterns refuses what it cannot do, in one line", "[patterns]") {
  const TempFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  const auto refused = [](const std::string& arguments, const std::string& words) {
    const Outcome outcome = beltpick_run("patterns " + arguments);
    INFO(arguments << ": " << outcome.err);
    CHECK(outcome.exit_code != 0);
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find(words) != std::string::npos);
  };
  refused("--projector 912" + out, "912x1140");
  refused("--projector -912x1140" + out, "912x1140");
  refused("--projector 912x1140x3" + out, "912x1140");
  refused("--projector 99999999x9" + out, "912x1140");
  refused("--projector 12x12" + out, "at least 20 columns");
  refused("--projector 912x1140", "--out");
  refused(out, "--projector");
  refused("--lcr4500 --projector 1280x800" + out, "912x1140");
  refused("--lcr4500 --layout square" + out, "diamond");
  refused("--projector 912x1140 --sequence slow" + out, "robust");
  refused("--projector 912x1140 --axes diagonal" + out, "column");
  refused("--projector 912x1140 --out " + folder.file("plain", "x").string(), "plain");
  refused("--projector 912x1140 --out /proc/nowhere", "/proc/nowhere");
  refused("--projector 912x1140 --bogus" + out, "bogus");
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
}
