// What the options of beltpick simulate are, and what follows from them at once: the rig and the sequence.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/capture.hpp"
#include "session.hpp"
#include "simulate_live.hpp"
#include "simulate_targets.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::cli {

struct SimulateOptions {
  std::string out, write_parts, rig_file, camera_size, projector_size, board;
  std::string scene = "belt", sequence = "standard", axes = "column";
  std::vector<std::string> parts{"knuckle"}, lays;
  double mm_per_unit = 1.0;
  int count = 1, parts_in_view = 3;
  std::uint64_t seed = 1;
  bool noise_free = false;
  double drift_px = 0.0, drift_mm = 0.0;
  virtual_cell::RigOptions rig;
  virtual_cell::RenderOptions render;
  TargetOptions targets;
  LiveOptions live;
};

// How a part lies, in the order of virtual_cell::Lay.
const std::vector<std::string>& lay_names();

void add_simulate_options(CLI::App& app, SimulateOptions& options);

// The rig that --rig and the other options describe. Errors: kUsage and those of virtual_cell::make_rig.
Result<virtual_cell::Rig> chosen_rig(const SimulateOptions& options, const CLI::App& app);

// A named sequence for the rig's projector, or a sequence.json made for it. Errors: kCalibrationMismatch for another
// projector's, and those of reading.
Result<Sequence> chosen_sequence(const SimulateOptions& options, const virtual_cell::Rig& rig, const Session& session);

}  // namespace beltpick::cli
