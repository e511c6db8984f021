// What the captures of beltpick simulate are of: parts laid down by seed, or scenes of known shape.
#pragma once

#include <memory>
#include <vector>

#include "base/result.hpp"
#include "contract_io/warnings.hpp"
#include "simulate_options.hpp"
#include "virtual_cell/render/scene.hpp"
#include "virtual_cell/render/target_scene.hpp"

namespace beltpick::cli {

// The parts that --part names. Errors: those of virtual_cell::load_part.
Result<std::vector<virtual_cell::ScenePart>> load_parts(const SimulateOptions& options);

class Stage {
 public:
  // `options` and `rig` must outlive the stage. Errors: those of the parts and of the scene's making.
  static Result<Stage> make(const SimulateOptions& options, const virtual_cell::Rig& rig);

  [[nodiscard]] const std::vector<virtual_cell::ScenePart>& parts() const { return parts_; }

  // What capture `k` shows. Warns where there was not room for all parts. Error: kUsage for a scene of no known name.
  Result<virtual_cell::TargetScene> scene(int k, contract_io::Warnings& warnings) const;

 private:
  Stage(const SimulateOptions& options, const virtual_cell::Rig& rig) : options_(&options), rig_(&rig) {}

  const SimulateOptions* options_;
  const virtual_cell::Rig* rig_;
  std::vector<virtual_cell::ScenePart> parts_;
  std::vector<virtual_cell::TargetScene> targets_;
  std::unique_ptr<virtual_cell::SceneMaker> maker_;
};

}  // namespace beltpick::cli
