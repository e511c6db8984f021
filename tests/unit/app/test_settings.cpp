#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

#include "app/line_settings.hpp"
#include "app/settings.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

struct File {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "beltpickd_settings_test.toml";
  explicit File(const std::string& text) { std::ofstream(path) << text; }
  ~File() { std::filesystem::remove(path); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
};

Result<Settings> read(const std::string& text, std::vector<std::string>& warnings) {
  const File file(text);
  return read_settings(file.path, warnings);
}

}  // namespace

TEST_CASE("the printed default reads back as the defaults, without a warning", "[settings]") {
  std::vector<std::string> warnings;
  const auto settings = read(default_settings_text(), warnings);
  REQUIRE(settings);
  CHECK(warnings.empty());
  CHECK(settings->plc_port == Settings{}.plc_port);
  CHECK(settings->limits.grid_cells == Limits{}.grid_cells);
  CHECK(settings->recipes == Settings{}.recipes);
  CHECK(settings->gripper.jaw_width_mm == GripperShape{}.jaw_width_mm);
}

TEST_CASE("every key of the printed default has a meaning beside it", "[settings]") {
  std::istringstream text(default_settings_text());
  int keys = 0;
  for (std::string line; std::getline(text, line);) {
    if (line.find(" = ") == std::string::npos) continue;
    ++keys;
    INFO(line);
    CHECK(line.find("# ") != std::string::npos);
    CHECK(line.size() > line.find("# ") + 4);
  }
  CHECK(keys > 40);
}

TEST_CASE("an empty file is all defaults; paths count from the file's folder", "[settings]") {
  std::vector<std::string> warnings;
  const auto settings = read("", warnings);
  REQUIRE(settings);
  CHECK(settings->settle_ms == 200);
  CHECK(from_settings(*settings, "a/b.json") == std::filesystem::temp_directory_path() / "a/b.json");
  CHECK(from_settings(*settings, "/x.json") == "/x.json");
  CHECK(from_settings(*settings, "").empty());
}

TEST_CASE("wrong values name key, line and what was expected; unknown keys warn", "[settings]") {
  std::vector<std::string> warnings;
  const auto port = read("[plc]\nport = 70000\n", warnings);
  REQUIRE_FALSE(port);
  CHECK(port.error().code == ResultCode::kValueOutOfRange);
  CHECK(port.error().text().find("line 2") != std::string_view::npos);
  CHECK(port.error().text().find("plc.port") != std::string_view::npos);
  const auto order = read("[plc]\nfloat_order = \"middle\"\n", warnings);
  REQUIRE_FALSE(order);
  CHECK(order.error().text().find("high-first or low-first") != std::string_view::npos);
  CHECK_FALSE(read("[model]\nrecipes = []\n", warnings));
  CHECK_FALSE(read("[plc\n", warnings));
  warnings.clear();
  CHECK(read("[plc]\nprot = 3\n", warnings));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("prot") != std::string::npos);
}

TEST_CASE("lines are judged with the source that needs them", "[settings]") {
  const std::string wired =
      "[trigger]\nsource = \"lines\"\n[lines]\nbelt_stopped = \"0\"\nemergency_stop = \"1 active-low pull-up\"\n"
      "camera = \"2\"\nprojector = \"3\"\n";
  std::vector<std::string> warnings;
  const auto good = read(wired + "strobe = \"usb-dio:STROBE\"\nbusy = \"5\"\n", warnings);
  REQUIRE(good);
  CHECK(warnings.empty());
  CHECK(triggers_by_lines(*good));
  CHECK(line_trigger_config(*good).strobe == capture::LineSpec{"usb-dio", "STROBE", false, capture::LineBias::kAsIs});
  CHECK(cell_lines_config(*good).emergency_stop ==
        capture::LineSpec{"gpiochip0", "1", true, capture::LineBias::kPullUp});
  CHECK_FALSE(cell_lines_config(*good).busy.wired());  // ours to drive, not to read

  const auto expect = [&](const std::string& text, ResultCode code, const char* key) {
    CAPTURE(text);
    const auto judged = read(text, warnings);
    REQUIRE_FALSE(judged);
    CHECK(judged.error().code == code);
    CHECK_THAT(judged.error().detail, Catch::Contains(key));
  };
  expect(wired, ResultCode::kMemberMissing, "lines.strobe");
  expect(wired + "strobe = \"4\"\nstart = \"5\"\n", ResultCode::kValueOutOfRange, "lines.start");
  expect("[lines]\ncamera = \"2\"\n", ResultCode::kValueOutOfRange, "lines.camera");
  expect("[lines]\nbusy = \"2 active-high\"\n", ResultCode::kValueOutOfRange, "lines.busy");
  expect("[trigger]\nsource = \"magic\"\n", ResultCode::kValueOutOfRange, "trigger.source");
}
