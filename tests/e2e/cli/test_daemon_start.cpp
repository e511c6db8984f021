// beltpickd --check on what an engineer may configure wrongly: one line that says where, before anything starts.
#include <nlohmann/json.hpp>

#include "workshop.hpp"

using namespace beltpick::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kRecipe = R"({"format": "beltpick-recipe", "version": 1, "number": 1, "name": "knuckles",
 "sequence": "sequence.json", "exposure_us": 8000, "settle_us": 1000, "period_us": 22000,
 "templates": ["knuckle.template"]})";

// A folder with all that a cell of the workshop's rig needs.
struct Site {
  TempFolder folder;

  Site() {
    for (const char* file : {"calibration.json", "cell.json", "sequence.json"}) {
      fs::copy_file(workshop() / "scene" / file, folder / file);
    }
    fs::copy_file(workshop() / "knuckle.template", folder / "knuckle.template");
    (void)folder.file("recipe.json", kRecipe);
  }

  // `config` and the limits of the workshop's small camera, and `limits`.
  [[nodiscard]] Outcome check(const std::string& config, const std::string& limits = "") const {
    const std::string whole = config + "\n[limits]\nimage_width = 160\nimage_height = 120\n" + limits;
    return run_program("beltpickd", "--check --config " + folder.file("beltpickd.toml", whole).string());
  }
};

// The log's lines may stand before it: the last line is the reason.
void refused(const Outcome& outcome, const std::string& words) {
  INFO(outcome.err);
  CHECK(outcome.exit_code == 1);
  const std::size_t last = outcome.err.rfind("\nbeltpickd: ") + 1;  // 0 where it is the only line
  CHECK(outcome.err.find("beltpickd: ", last) == last);
  CHECK(outcome.err.find('\n', last) == outcome.err.size() - 1);
  CHECK(outcome.err.find(words, last) != std::string::npos);
}

}  // namespace

TEST_CASE("A good configuration is accepted with its memory budget", "[daemon]") {
  const Site site;
  const Outcome outcome = site.check("");
  INFO(outcome.err);
  CHECK(outcome.exit_code == 0);
  CHECK((outcome.out + outcome.err).find("MB") != std::string::npos);
}

TEST_CASE("The printed configuration is read back without a warning", "[daemon]") {
  const TempFolder folder;
  const Outcome defaults = run_program("beltpickd", "--print-config");
  CHECK(defaults.exit_code == 0);
  const Outcome outcome = run_program("beltpickd", "--check --config " + folder.file("d.toml", defaults.out).string());
  CHECK(outcome.err.find("unknown key") == std::string::npos);
  refused(outcome, "calibration.json");  // nothing but the model files is missing
}

TEST_CASE("Wrong keys and values are named with their line", "[daemon]") {
  const Site site;
  refused(site.check("[plc]\nport = \"modbus\"\n"), "line 2: plc.port");
  refused(site.check("[plc]\nport = 99999\n"), "line 2: plc.port");
  refused(site.check("[cycle]\nmax_age_ms = -1\n"), "line 2: cycle.max_age_ms");
  refused(site.check("[plc\n"), "line 1");
  const Outcome misspelt = site.check("[plc]\nprot = 1502\n");
  CHECK(misspelt.exit_code == 0);
  CHECK((misspelt.out + misspelt.err).find("plc.prot") != std::string::npos);
}

TEST_CASE("A sequence that exceeds the declared limits names the limit and what it takes", "[daemon]") {
  const auto with = [](const std::string& members, const std::string& limits) {
    const Site site;
    auto recipe = nlohmann::json::parse(kRecipe);
    recipe.update(nlohmann::json::parse(members));
    (void)site.folder.file("recipe.json", recipe.dump());
    return site.check("", limits);
  };
  const std::string hdr = R"({"sequence": "standard", "exposures_us": [2000, 8000, 20000], "period_us": 0})";
  const std::string micro = R"({"sequence": "micro"})";
  const std::string both = R"({"axes": "both", "sequence": "fast"})";
  for (const std::string& recipe : {hdr, micro}) CHECK(with(recipe, "").exit_code == 0);
  refused(with(hdr, "decode_bytes = 16\n"), "set limits.decode_bytes = ");
  refused(with(hdr, "frames = 22\n"), "limits.frames");
  refused(with(micro, "decode_bytes = 12\n"), "set limits.decode_bytes = ");
  refused(with(both, ""), "set limits.code_rows = true");
  CHECK(with(both, "code_rows = true\n").exit_code == 0);
}

TEST_CASE("Model files that are missing, damaged or of another rig are named", "[daemon]") {
  const auto spoilt = [](const std::string& words, auto spoil) {
    const Site site;
    spoil(site.folder);
    refused(site.check(""), words);
  };
  spoilt("calibration.json", [](const TempFolder& folder) { fs::remove(folder / "calibration.json"); });
  spoilt("knuckle.template", [](const TempFolder& folder) { fs::remove(folder / "knuckle.template"); });
  spoilt("knuckle.template", [](const TempFolder& folder) { fs::resize_file(folder / "knuckle.template", 5000); });
  spoilt("recipe.json", [](const TempFolder& folder) { fs::resize_file(folder / "recipe.json", 30); });
  spoilt("projector", [](const TempFolder& folder) {
    auto json = nlohmann::json::parse(file_bytes(folder / "calibration.json"));
    json["projector"]["width"] = 912;
    (void)folder.file("calibration.json", json.dump());
  });
  spoilt("calibration", [](const TempFolder& folder) {
    auto json = nlohmann::json::parse(file_bytes(folder / "cell.json"));
    json["calibration_id"] = "of another rig";
    (void)folder.file("cell.json", json.dump());
  });
}

TEST_CASE("A wrong command line of the daemon is refused", "[daemon]") {
  for (const char* arguments : {"", "--config", "--bogus", "--config /nowhere --what"}) {
    const Outcome outcome = run_program("beltpickd", arguments);
    INFO(arguments << ": " << outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.error_lines() == 1);
  }
}
