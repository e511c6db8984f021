// beltpick simulate: the scenes of known shape: calibration plates and targets for trueness.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "virtual_cell/render/plate.hpp"
#include "virtual_cell/render/target_scene.hpp"

namespace beltpick::cli {

struct TargetOptions {
  std::string board = "11x8", print = "chess", poses = "good";
  virtual_cell::PlateOptions plate;
};

// Parts, and for each capture what of them stands where.
struct TargetStage {
  std::vector<virtual_cell::ScenePart> parts;
  std::vector<virtual_cell::TargetScene> scenes;
};

void add_target_options(CLI::App& app, TargetOptions& options);

// Whether `scene` is one of those made here.
bool is_target_scene(const std::string& scene);

// `count` captures of the scene. Errors: kUsage and kValueOutOfRange for what cannot be shown.
Result<TargetStage> make_target_stage(const std::string& scene, const TargetOptions& options,
                                      const virtual_cell::Rig& rig, int count, std::uint64_t seed);

}  // namespace beltpick::cli
