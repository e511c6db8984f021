// ModelStore: the templates in use, each in a slot of fixed size with its closest-point grid built.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/arena.hpp"
#include "base/result.hpp"
#include "contract/gripper.hpp"
#include "contract/limits.hpp"
#include "contract/part_model.hpp"
#include "contract/part_template.hpp"

namespace beltpick::pipeline {

// Whether `part` fits the limits. Errors: kTemplateTooLarge (points, symmetries or grasps), kNoTemplate (no points).
Result<void> check_template(const PartTemplate& part, const Limits& limits);

// Whether a ModelStore of these limits can hold them all. Errors: as above; kLimitExceeded (number of templates),
// kNoTemplate (none given).
Result<void> check_templates(std::span<const PartTemplate> templates, const Limits& limits);

class ModelStore {
 public:
  // Takes the memory of limits.templates slots of limits.template_points points and limits.grid_cells cells each.
  // Without cells the k-d tree answers in the grid's place; it takes its memory beside the arena, when loaded.
  ModelStore(Arena& arena, const Limits& limits);

  // Replaces what is loaded. Takes about 0.2 s a template; not while a locate is running. All or nothing. Errors: those
  // of check_templates().
  Result<void> load(std::span<const PartTemplate> templates, const GripperShape& gripper = {});

  [[nodiscard]] std::span<const PartModel> models() const { return models_.first(count_); }

 private:
  struct Slot {
    std::span<OrientedPoint> surface;
    std::span<PointBlock> fine;
    std::span<PointBlock> coarse;
    std::span<PointBlock> scattered;
    std::span<std::uint16_t> grid;
  };
  void index_surface(Slot& slot, std::unique_ptr<ClosestPointTree>& tree, PartModel& model) const;
  void fill(const PartTemplate& part, const GripperShape& gripper, Slot& slot, PartModel& model) const;

  Limits limits_;
  std::span<PartModel> models_;
  std::span<Slot> slots_;
  std::vector<std::unique_ptr<ClosestPointTree>> trees_;  // one a slot, where there are no grids
  std::size_t count_ = 0;
};

}  // namespace beltpick::pipeline
