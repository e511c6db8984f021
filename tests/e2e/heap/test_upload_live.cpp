// An engineer uploads calibration, templates and recipes over HTTPS while the belt runs: no cycle is lost or ends in a
// fault, the threads of the design allocate nothing, what was offered with the old models is revoked, the new ones are
// in use, and the robot picks on.
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "base/clock.hpp"
#include "contract_io/calibration_io.hpp"
#include "contract_io/file_io.hpp"
#include "contract_io/recipe_io.hpp"
#include "contract_io/template_io.hpp"
#include "live_cell.hpp"
#include "support/run_program.hpp"

using namespace beltpick;
namespace fs = std::filesystem;

namespace {

constexpr int kParts = 48;
constexpr int kRounds = 4;  // each uploads all three

// The appliance's own log, which it writes to stderr.
class CaughtLog {
 public:
  explicit CaughtLog(const fs::path& file) : file_(file), stderr_(dup(2)) {
    const int log = open(file.c_str(), O_CREAT | O_WRONLY | O_APPEND, 0600);
    dup2(log, 2);
    close(log);
  }
  ~CaughtLog() {
    dup2(stderr_, 2);
    close(stderr_);
  }
  CaughtLog(const CaughtLog&) = delete;
  CaughtLog& operator=(const CaughtLog&) = delete;

  [[nodiscard]] int count(const std::string& words) const {
    const std::string text = test::file_bytes(file_);
    int found = 0;
    for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
    return found;
  }
  [[nodiscard]] std::string text() const { return test::file_bytes(file_); }

 private:
  fs::path file_;
  int stderr_;
};

// Other files of the same cell each time: of the same meaning, but not of the same bytes.
struct Variants {
  fs::path folder;
  contract_io::Warnings warnings;

  [[nodiscard]] fs::path calibration(int round) {
    auto calibration = *contract_io::read_calibration(live::cell_folder() / "calibration.json", warnings);
    calibration.projector_serial = "P" + std::to_string(round);
    REQUIRE(contract_io::write_calibration(folder / "calibration.json", calibration));
    return folder / "calibration.json";
  }
  [[nodiscard]] fs::path part(int round, const std::string& name = "knuckle") const {
    auto part = *contract_io::read_template(live::cell_folder() / "knuckle.template");
    part.grasps.front().name = "grasp of round " + std::to_string(round);
    REQUIRE(contract_io::write_template(folder / (name + ".template"), part));
    return folder / (name + ".template");
  }
  [[nodiscard]] fs::path recipe(int round) {
    auto recipe = *contract_io::read_recipe(live::cell_folder() / "recipe.json", warnings);
    recipe.name = "knuckles " + std::to_string(round);
    REQUIRE(contract_io::write_recipe(folder / "recipe.json", recipe));
    return folder / "recipe.json";
  }
  // One that is never active.
  [[nodiscard]] fs::path idle_recipe() const {
    Recipe recipe;
    recipe.number = 9;
    recipe.exposure_us = 8000;
    recipe.templates = {"idle"};
    REQUIRE(contract_io::write_recipe(folder / "other.json", recipe));
    return folder / "other.json";
  }
};

// `beltpick` as the engineer calls it.
struct Engineer {
  std::string to;

  [[nodiscard]] nlohmann::json status() const {
    const auto outcome = test::beltpick_run("status --json --to " + to);
    return outcome.exit_code == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
  }
  void upload(const std::string& kind, const fs::path& file) const {
    const auto outcome = test::beltpick_run("upload " + kind + " " + file.string() + " --to " + to);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
  }
  // The version of an item that the cell works with; 0 where it does without.
  [[nodiscard]] int version_in_use(const std::string& kind) const {
    const auto now = status();
    if (!now.is_object()) return 0;
    for (const auto& item : now["in_use"]) {
      if (item["kind"] == kind) return item["version"];
    }
    return 0;
  }
  [[nodiscard]] bool wait_in_use(const std::string& kind, int version, double patience_s) const {
    const Stopwatch watch;
    while (version_in_use(kind) != version) {
      if (watch.elapsed_ms() > patience_s * 1000) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return true;
  }
};

void enrol(const Engineer& engineer, const fs::path& state) {
  const Stopwatch watch;
  while (!fs::exists(state / "one_time_token") && watch.elapsed_ms() < 20000) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const auto outcome =
      test::beltpick_run("enrol --to " + engineer.to + " --token " + (state / "one_time_token").string());
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

// Told whenever the halves have changed places.
const std::string kChanged = "recipe 1 'knuckles";

void upload_what_is_not_in_use(const Engineer& engineer, const Variants& files, const CaughtLog& log) {
  const int at_start = log.count(kChanged);
  engineer.upload("template", files.part(0, "idle"));
  engineer.upload("recipe", files.idle_recipe());
  engineer.upload("template", files.part(1, "idle"));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  CHECK(log.count("MODEL_CHANGED") == 0);
  CHECK(log.count(kChanged) == at_start);
}

// Until poses are offered anew: what is uploaded then comes into use while one stands, mostly.
void wait_for_offers(const CaughtLog& log) {
  const int before = log.count("-> offering");
  const Stopwatch watch;
  while (log.count("-> offering") == before && watch.elapsed_ms() < 20000) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

// Whether each came into use.
bool upload_what_is_in_use(const Engineer& engineer, Variants& files, const CaughtLog& log) {
  bool used = true;
  const auto upload = [&](const std::string& kind, const fs::path& file, int version) {
    wait_for_offers(log);
    engineer.upload(kind, file);
    used = used && engineer.wait_in_use(kind, version, 20);
  };
  for (int round = 1; round <= kRounds; ++round) {
    upload("template", files.part(round), round + 1);
    upload("calibration", files.calibration(round), round + 1);
    upload("recipe", files.recipe(round), round + 1);
  }
  return used;
}

void check_report(const nlohmann::json& report, const app::RunBook::Totals& totals) {
  REQUIRE(report.is_object());
  CHECK(report["finished"] == true);
  CHECK(report["crashes"] == 0);
  CHECK(report["unsafe"] == 0);
  CHECK(report["picked"].get<int>() + report["tray"].get<int>() == report["parts"].get<int>());
  CHECK(report["picked"].get<int>() * 10 >= report["parts"].get<int>() * 9);
  CHECK(report["cycles"].get<int>() == totals.cycles);  // none was begun anew
}

}  // namespace

TEST_CASE("uploads while the belt runs lose no cycle and allocate nothing where nothing may", "[upload]") {
  const fs::path run = fs::temp_directory_path() / ("beltpick_upload_" + std::to_string(getpid()));
  fs::create_directories(run / "files");
  setenv("XDG_CONFIG_HOME", (run / "config").c_str(), 1);
  const std::uint16_t plc_port = live::free_port(), service_port = live::free_port();
  live::VirtualCell world(run, plc_port, kParts, 7, 5);
  app::Settings settings = live::settings_for(run, plc_port);
  settings.state = run / "state";
  settings.service_port = service_port;

  const CaughtLog log(run / "log");
  live::RunningAppliance appliance(settings);

  const Engineer engineer{"127.0.0.1:" + std::to_string(service_port)};
  enrol(engineer, settings.state);
  Variants files{run / "files", {}};
  const bool began = live::wait_for_cycles(*appliance, 2, 60);
  const int at_start = log.count(kChanged);
  heap::start();

  upload_what_is_not_in_use(engineer, files, log);
  const bool used = upload_what_is_in_use(engineer, files, log);
  const int cycles_then = appliance.book().counts().cycles;
  CHECK(live::wait_for_cycles(*appliance, cycles_then + 2, 60));
  heap::stop();
  const auto counts = heap::counts();

  const auto report = world.wait_report(120);
  const app::RunBook::Totals totals = appliance.book().totals();
  const int exit_code = appliance.stop();
  const std::string told = log.text();
  INFO(told.substr(told.size() - std::min<std::size_t>(told.size(), 6000)));
  CHECK(exit_code == 0);
  CHECK(began);
  CHECK(used);
  CHECK(log.count("offer revoked: 122 MODEL_CHANGED") > 0);
  CHECK(log.count(kChanged) - at_start == 3 * kRounds);
  CHECK(totals.faults.empty());

  check_report(report, totals);
  live::check_counted_threads(counts);
  std::printf("  %d cycles, %d captures, %d uploads in use, %d offers revoked for them, picked %d of %d\n",
              totals.cycles, totals.captures, 3 * kRounds, log.count("offer revoked: 122 MODEL_CHANGED"),
              report["picked"].get<int>(), report["parts"].get<int>());
  fs::remove_all(run);
}
