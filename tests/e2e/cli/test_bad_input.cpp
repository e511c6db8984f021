// Everything that reads a capture, given what a stranger may hand it: one line on stderr, a failing exit code, and none
// of the files asked for.
#include <catch2/catch.hpp>
#include <functional>
#include <nlohmann/json.hpp>

#include "cli_help.hpp"
#include "workshop.hpp"

using namespace beltpick::test;
namespace fs = std::filesystem;

namespace {

// How each command is called on `input` with `calibration`, writing to `out`.
struct Reader {
  std::string command;
  std::string options;  // with OUT for the file it writes
};

std::vector<Reader> readers() {
  const std::string taught = (workshop() / "knuckle.template").string();
  std::vector<Reader> all{{"decode", "--out OUT"},
                          {"segment", "--out OUT"},
                          {"primitives", "--json"},
                          {"locate", "--template " + taught + " --out OUT"}};
  const auto listed = listed_commands();
  std::erase_if(all, [&](const Reader& reader) {
    return std::find(listed.begin(), listed.end(), reader.command) == listed.end();
  });
  return all;
}

void refused(const std::string& input, const std::string& calibration, const std::string& words) {
  for (const Reader& reader : readers()) {
    const TempFolder folder;
    std::string options = reader.options;
    if (const std::size_t at = options.find("OUT"); at != std::string::npos) {
      options.replace(at, 3, (folder / "out.bin").string());
    }
    const Outcome outcome =
        beltpick_run(reader.command + " '" + input + "' --calibration '" + calibration + "' " + options);
    INFO(reader.command << " " << input << ": " << outcome.err);
    CHECK((outcome.exit_code == 1 || outcome.exit_code == 2));
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find(words) != std::string::npos);
    CHECK(fs::is_empty(folder.path()));
  }
}

// The workshop's capture with something done to it.
void capture_refused(const std::function<void(const fs::path&)>& spoil, const std::string& words) {
  const TempFolder folder;
  fs::copy(workshop() / "scene", folder / "scene");
  spoil(folder / "scene");
  refused((folder / "scene").string(), (folder / "scene/calibration.json").string(), words);
}

// Changes capture.json or calibration.json.
void edit(const fs::path& file, const std::function<void(nlohmann::json&)>& change) {
  nlohmann::json json = nlohmann::json::parse(file_bytes(file));
  change(json);
  std::ofstream(file) << json;
}

void cut(const fs::path& file, std::uintmax_t bytes) { fs::resize_file(file, bytes); }

}  // namespace

TEST_CASE("Inputs that are no capture at all", "[bad_input]") {
  const TempFolder folder;
  const std::string calibration = (workshop() / "scene/calibration.json").string();
  refused((folder / "absent").string(), calibration, "absent");
  refused(folder.path().string(), calibration, "without capture.json");
  refused(folder.file("note.txt", "hello").string(), calibration, "note.txt");
  refused(folder.file("cut.zip", "PK\x03\x04").string(), calibration, "cut.zip");
  refused(folder.file("text.npy", "hello").string(), calibration, "text.npy");
}

TEST_CASE("Captures with a file missing, cut or of another kind", "[bad_input]") {
  capture_refused([](const fs::path& scene) { fs::remove(scene / "003.png"); }, "003.png");
  capture_refused([](const fs::path& scene) { cut(scene / "003.png", 200); }, "003.png");
  capture_refused([](const fs::path& scene) { cut(scene / "000.png", 0); }, "000.png");
  capture_refused([](const fs::path& scene) { std::ofstream(scene / "004.png") << "no image"; }, "004.png");
  capture_refused([](const fs::path& scene) { cut(scene / "capture.json", 150); }, "capture.json");
  capture_refused([](const fs::path& scene) { cut(scene / "calibration.json", 150); }, "calibration.json");
  capture_refused([](const fs::path& scene) { fs::remove(scene / "calibration.json"); }, "calibration.json");
}

TEST_CASE("Captures whose frames differ in size", "[bad_input]") {
  const TempFolder other;
  REQUIRE(beltpick_run("patterns --projector 160x121 --out " + (other / "p").string()).exit_code == 0);
  capture_refused(
      [&](const fs::path& scene) {
        fs::copy_file(other / "p/005.png", scene / "005.png", fs::copy_options::overwrite_existing);
      },
      "005.png");
}

TEST_CASE("Captures whose JSON is wrong name the member", "[bad_input]") {
  const auto spoilt = [](const std::function<void(nlohmann::json&)>& change, const std::string& words) {
    capture_refused([&](const fs::path& scene) { edit(scene / "capture.json", change); }, words);
  };
  spoilt([](auto& json) { json["frames"][2]["kind"] = "stripes"; }, "frames[2].kind");
  spoilt([](auto& json) { json["frames"][1]["period_px"] = "wide"; }, "frames[1].period_px");
  spoilt([](auto& json) { json["frames"] = nlohmann::json::array(); }, "frames");
  spoilt([](auto& json) { json.erase("projector"); }, "projector");
  spoilt([](auto& json) { json["version"] = 7; }, "version");
  spoilt([](auto& json) { json["frames"][0]["file"] = "../../etc/passwd"; }, "frames[0].file");
}

TEST_CASE("Captures that cannot be decoded say why", "[bad_input]") {
  capture_refused(
      [](const fs::path& scene) {
        edit(scene / "capture.json", [](auto& json) { json["frames"].erase(8); });  // the highest Gray bit
      },
      "[SEQUENCE_UNDECODABLE]");
  capture_refused(
      [](const fs::path& scene) {
        edit(scene / "capture.json", [](auto& json) {
          json["frames"] = {{{"file", "000.png"}, {"kind", "white"}}, {{"file", "001.png"}, {"kind", "black"}}};
        });
      },
      "[SEQUENCE_UNDECODABLE]");
}

TEST_CASE("A calibration of another camera or projector is refused", "[bad_input]") {
  const auto spoilt = [](const std::function<void(nlohmann::json&)>& change, const std::string& words) {
    capture_refused([&](const fs::path& scene) { edit(scene / "calibration.json", change); }, words);
  };
  spoilt([](auto& json) { json["camera"]["width"] = 161; }, "[CALIBRATION_MISMATCH]");
  spoilt([](auto& json) { json["projector"]["height"] = 1140; }, "[CALIBRATION_MISMATCH]");
  spoilt([](auto& json) { json["camera"]["matrix"][0][0] = -1; }, "camera.matrix");
  spoilt([](auto& json) { json["projector_from_camera"]["rotation"][0][0] = 2; }, "rotation");
}

TEST_CASE("What cannot be written is an error", "[bad_input]") {
  const std::string scene = (workshop() / "scene").string();
  for (const Reader& reader : readers()) {
    std::string options = reader.options;
    const std::size_t at = options.find("OUT");
    if (at == std::string::npos) continue;
    options.replace(at, 3, "/proc/nowhere/out.bin");
    const Outcome outcome =
        beltpick_run(reader.command + " " + scene + " --calibration " + scene + "/calibration.json " + options);
    INFO(reader.command << ": " << outcome.err);
    CHECK(outcome.exit_code == 1);
    CHECK(outcome.error_lines() == 1);
    CHECK(outcome.err.find("/proc/nowhere") != std::string::npos);
  }
}
