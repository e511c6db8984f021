// The service with a real store and a stand-in for the cell, for clients that are not ours.
//   api_test_server STATE [requests_per_minute [request_s]]
// Prints its port and runs until stdin ends. The stand-in takes any calibration, cell and recipe that is a JSON object,
// any template that begins with "beltpick", and warns of one that contains "dusty"; it cannot do without the template
// "needed".
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "contract/result_codes.hpp"
#include "service/service.hpp"

using namespace beltpick;
using namespace beltpick::service;

namespace {

class StandIn : public CellSide {
 public:
  [[nodiscard]] CellStatus status() const override {
    CellStatus status;
    status.state = "idle";
    status.model_code = ResultCode::kNoCalibration;
    status.recipe = 1;
    status.recipe_name = "knuckles";
    status.camera_serial = "BP-1001";
    status.pixels = {899, 11, 0, 84, 1, 5, 0};
    status.belt_nearer_mm = -0.125;
    return status;
  }
  Result<void> judge(const ItemId& id, std::string_view bytes, std::vector<std::string>& warnings) override {
    const std::string_view start = id.kind == ItemKind::kTemplate ? "beltpick" : "{";
    if (!bytes.starts_with(start)) {
      return failure(ResultCode::kFormatInvalid, "%s: expected a file that starts with %s, found another",
                     id.name.c_str(), start.data());
    }
    if (bytes.find("dusty") != std::string_view::npos) warnings.push_back(id.name + ": it is dusty");
    return {};
  }
  Result<void> judge_removal(const ItemId& id) override {
    if (id.name != "needed") return {};
    return failure(ResultCode::kUsage, "template needed: expected no recipe to need it, found knuckles; change it");
  }
  void changed(const ItemId& id) override { std::fprintf(stderr, "changed %s\n", id.name.c_str()); }
  SelfTestReport self_test() override {
    return {"2026-01-31T12:34:56Z", {{"camera", Verdict::kWarning, "none answers", "it is a stand-in", "none"}}};
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const std::filesystem::path state = argv[1];
  std::vector<std::string> warnings;
  auto store = Store::open(state / "store", warnings);
  if (!store) return 1;
  StandIn cell;
  ServerConfig config;
  config.port = 0;
  if (argc > 2) config.requests_per_minute = std::atoi(argv[2]);
  if (argc > 3) config.request_s = config.idle_s = std::atoi(argv[3]);
  const auto log = [](bool warning, const std::string& line) {
    std::fprintf(stderr, "%s %s\n", warning ? "warn" : "info", line.c_str());
  };
  const auto service = Service::start(state, config, *store, cell, log, {[] {}, [] {}});
  if (!service) {
    std::fprintf(stderr, "%s\n", service.error().detail);
    return 1;
  }
  std::printf("%u\n", (*service)->port());
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
  }
  return (*service)->stop(2000) ? 0 : 1;
}
