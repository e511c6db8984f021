// Scenes of things whose shape is known: what stands where, and the truth that measurement is held against.
#pragma once

#include <optional>
#include <vector>

#include "contract/truth.hpp"
#include "virtual_cell/render/plate.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::virtual_cell {

struct TargetScene {
  std::vector<PartInstance> instances;
  std::optional<TruePlate> plate;
  std::vector<TrueTarget> targets;
};

// The plate in one pose, as part 0, with the truth of its corners.
TargetScene plate_scene(const Rig& rig, const Plate& plate, const Pose<frame::Belt, frame::Part>& T_belt_plate);

}  // namespace beltpick::virtual_cell
