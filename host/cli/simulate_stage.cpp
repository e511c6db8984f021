#include "simulate_stage.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "virtual_cell/render/capture_folder.hpp"

namespace beltpick::cli {
namespace {

namespace vc = virtual_cell;

Result<vc::Scene> lay_parts(const SimulateOptions& options, const vc::SceneMaker& maker, std::uint64_t seed) {
  if (options.scene.starts_with("paper:")) return maker.make_paper_scene(std::atoi(options.scene.c_str() + 6), seed);
  if (options.scene == "bare" || options.scene == "plane") return vc::Scene{};
  if (options.scene != "belt")
    return failure(
        ResultCode::kUsage,
        "--scene: expected paper:1..12, belt, plane, bare, plate, plate-on-belt, planes, sphere or steps, found '%s'",
        contract_io::one_line(options.scene).substr(0, 60).c_str());
  if (options.lays.empty() && options.parts_in_view == 3) return maker.make_belt(3, seed).front();
  std::vector<vc::Lay> lays(static_cast<std::size_t>(options.parts_in_view), vc::Lay::kAny);
  for (std::size_t i = 0; i < std::min(lays.size(), options.lays.size()); ++i) {
    lays[i] =
        static_cast<vc::Lay>(std::find(lay_names().begin(), lay_names().end(), options.lays[i]) - lay_names().begin());
  }
  return maker.make(lays, seed);
}

}  // namespace

Result<std::vector<vc::ScenePart>> load_parts(const SimulateOptions& options) {
  std::vector<vc::ScenePart> parts;
  for (const std::string& name : options.parts) {
    auto part = vc::load_part(name, options.mm_per_unit);
    if (!part) return std::unexpected(part.error());
    parts.push_back(std::move(*part));
  }
  return parts;
}

Result<Stage> Stage::make(const SimulateOptions& options, const vc::Rig& rig) {
  Stage stage(options, rig);
  if (is_target_scene(options.scene, options.targets)) {
    auto targets = make_target_stage(options.scene, options.targets, rig, options.count, options.seed);
    if (!targets) return std::unexpected(targets.error());
    stage.parts_ = std::move(targets->parts);
    stage.targets_ = std::move(targets->scenes);
    return stage;
  }
  auto parts = load_parts(options);
  if (!parts) return std::unexpected(parts.error());
  stage.parts_ = std::move(*parts);
  stage.maker_ = std::make_unique<vc::SceneMaker>(stage.parts_, rig);
  return stage;
}

Result<vc::TargetScene> Stage::scene(int k, contract_io::Warnings& warnings) const {
  if (maker_ == nullptr) return targets_[static_cast<std::size_t>(k)];
  const std::uint64_t seed = options_->seed + static_cast<std::uint64_t>(k);
  const auto scene = lay_parts(*options_, *maker_, seed);
  if (!scene) return std::unexpected(scene.error());
  const auto wanted = static_cast<std::size_t>(options_->scene == "belt" ? options_->parts_in_view : 0);
  if (scene->size() < wanted) {
    warnings.push_back("seed " + std::to_string(seed) + ": room for " + std::to_string(scene->size()) +
                       " parts in view, " + std::to_string(wanted) + " asked for");
  }
  return vc::TargetScene{vc::instances_of(*scene, *rig_), {}, {}};
}

}  // namespace beltpick::cli
