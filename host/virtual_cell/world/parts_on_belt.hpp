// PartsOnBelt: the truth of one view: which parts lie where, whether a pick succeeds, and what the others do after it.
#pragma once

#include <span>
#include <vector>

#include "contract/gripper.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_part.hpp"
#include "virtual_cell/render/scene_renderer.hpp"
#include "virtual_cell/render/settle.hpp"
#include "virtual_cell/world/plant.hpp"
#include "virtual_cell/world/plc_link.hpp"

namespace beltpick::virtual_cell {

// A worse pose counts as a crash.
struct PickLimits {
  double position_mm = 1.0;  // at the part's centre of mass
  double angle_deg = 1.0;
};

struct PickJudgement : PickResult {
  int index = -1;  // of the part gripped, into parts()
};

class PartsOnBelt {
 public:
  // `parts` must outlive this.
  PartsOnBelt(std::span<const ScenePart> parts, const Rig& rig);

  void set(Scene scene) { scene_ = std::move(scene); }
  void shift(double along_mm);
  [[nodiscard]] const Scene& parts() const { return scene_; }
  [[nodiscard]] std::vector<PartInstance> instances() const;

  // Judges a pick by the truth: pose modulo the part's symmetries, then the gripper's way in against belt and meshes.
  [[nodiscard]] PickJudgement judge(const Offer& offer) const;

  // Takes a part away; what lay on it or leaned against it settles anew.
  void remove(int index);

 private:
  [[nodiscard]] Pose<frame::Belt, frame::Part> part_in_belt(const Offer& offer) const;
  [[nodiscard]] Pose<frame::Belt, frame::Gripper> gripper_in_belt(const Offer& offer) const;
  // What the jaws meet on their way to part `index`; null: nothing.
  [[nodiscard]] const char* in_the_way(const Offer& offer, int index) const;

  std::span<const ScenePart> parts_;
  Settler settler_;
  Rig rig_;
  PickLimits limits_;
  GripperShape gripper_;
  Scene scene_;
};

}  // namespace beltpick::virtual_cell
