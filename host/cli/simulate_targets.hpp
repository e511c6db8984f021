// beltpick simulate: the scenes of known shape: calibration plates and targets for trueness.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "base/result.hpp"
#include "virtual_cell/render/plate.hpp"
#include "virtual_cell/render/trueness_targets.hpp"

namespace beltpick::cli {

struct TargetOptions {
  std::string board = "11x8", print = "chess", poses = "good";
  virtual_cell::PlateOptions plate;
  virtual_cell::BallBarOptions balls;
  virtual_cell::StepOptions steps;
  std::optional<double> height_mm, tilt_deg;
  double towards_deg = 0.0;
};

void add_target_options(CLI::App& app, TargetOptions& options);

// Whether the scene is one of those made here. A plane is where a height or a tilt is given; else it is the belt
// itself.
bool is_target_scene(const std::string& scene, const TargetOptions& options);
bool is_plate_scene(const std::string& scene);

// `count` captures of the scene. Errors: kUsage and kValueOutOfRange for what cannot be shown.
Result<virtual_cell::TargetStage> make_target_stage(const std::string& scene, const TargetOptions& options,
                                                    const virtual_cell::Rig& rig, int count, std::uint64_t seed);

}  // namespace beltpick::cli
