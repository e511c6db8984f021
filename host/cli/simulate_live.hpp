// beltpick simulate --live: the virtual cell in real time, for a beltpickd that runs beside it.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "session.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_part.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::cli {

struct LiveOptions {
  bool live = false;
  double faults = 0.0;  // share of the belt's stops that are hit by a fault
  std::vector<std::string> named_faults;
  std::string plc = "127.0.0.1:1502";
  std::string camera = "127.0.0.1";
  std::string serial = "BP0001";
  std::string trigger = "/tmp/beltpick-trigger";
  std::string board = "host";
  std::string firmware;
  std::string report;
  std::string pictures;
  std::string switches;
  int wait_s = 60;
  int linger_s = 0;
  double speed = 1.0;
};

// The cell that is simulated.
struct LiveCell {
  virtual_cell::Rig rig;
  std::vector<virtual_cell::ScenePart> parts;  // in the order of the recipe
  Sequence sequence;                           // that the projector holds
  virtual_cell::RenderOptions render;
  int count = 24;  // parts on the belt
  std::uint64_t seed = 1;
};

void add_live_options(CLI::App& app, LiveOptions& options);

// Runs the belt until it is empty, ctrl-C or SIGTERM; writes the report. Fails where a device cannot be opened or the
// appliance falls silent; crashes and failed picks are findings, not failures.
Result<void> run_live(const LiveOptions& options, LiveCell cell, Session& session);

}  // namespace beltpick::cli
