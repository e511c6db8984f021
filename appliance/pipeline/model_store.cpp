#include "pipeline/model_store.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/plan_search.hpp"
#include "pipeline/spatial_order.hpp"
#include "pipeline/thin_surface.hpp"
#include "result/grasp_choice.hpp"
#include "search/views.hpp"

namespace beltpick::pipeline {
namespace {

// Blocks of points of a first impression: enough that one fifth of a part seen gives a hundred.
constexpr std::size_t kScattered = 16;
// So many spacings apart lie the points of the coarse surface: about a quarter of all.
constexpr float kThinning = 1.6F;
// Measured points farther away than this share of the part's size are no part of it; nor need the grid reach farther.
constexpr double kMarginShare = 0.07;

void scatter(std::span<const OrientedPoint> surface, std::span<PointBlock> scattered) {
  Random random(1);
  for (PointBlock& block : scattered) {
    for (int i = 0; i < PointBlock::kSize; ++i)
      block.put(surface[random.below(static_cast<std::uint32_t>(surface.size()))], i);
  }
}

SurfaceBlocks block_up(std::span<const OrientedPoint> surface, float spacing_mm, std::span<PointBlock> blocks) {
  const auto used = blocks.first(PointBlock::blocks_for(surface.size()));
  for (std::size_t i = 0; i < used.size(); ++i) used[i].load(surface.subspan(i * PointBlock::kSize));
  return {used, surface.size(), spacing_mm, 1.0F};
}

SurfaceBlocks thin_out(std::span<const OrientedPoint> surface, const SurfaceBlocks& fine,
                       std::span<PointBlock> blocks) {
  const std::size_t count = thin_surface(surface, kThinning * fine.spacing_mm, blocks);
  const float stands_for = static_cast<float>(surface.size()) / static_cast<float>(count);
  return {blocks.first(PointBlock::blocks_for(count)), count, std::sqrt(stands_for) * fine.spacing_mm, stands_for};
}

void copy_symmetry(const Symmetry& symmetry, PartModel& model) {
  std::copy(symmetry.elements.begin(), symmetry.elements.end(), model.symmetries.begin());
  model.symmetry_count = static_cast<int>(symmetry.elements.size());
  model.sphere = symmetry.name == "sphere";
  model.revolution = symmetry.revolution;
  model.axis_point_mm = symmetry.axis_point_mm;
  model.axis_direction = symmetry.axis_direction.normalized();
}

}  // namespace

ModelStore::ModelStore(Arena& arena, const Limits& limits) : limits_(limits) {
  const auto slots = static_cast<std::size_t>(limits.templates);
  models_ = arena.take<PartModel>("templates: models", slots);
  slots_ = arena.take<Slot>("templates: models", slots);
  trees_.resize(slots);
  for (std::size_t i = 0; i < slots; ++i) {
    const Slot slot{
        arena.take<OrientedPoint>("templates: surface points", static_cast<std::size_t>(limits.template_points)),
        arena.take<PointBlock>("templates: surface points",
                               PointBlock::blocks_for(static_cast<std::size_t>(limits.template_points))),
        arena.take<PointBlock>("templates: surface points",
                               PointBlock::blocks_for(static_cast<std::size_t>(limits.template_points))),
        arena.take<PointBlock>("templates: surface points", kScattered),
        arena.take<std::uint16_t>("templates: closest-point grids", static_cast<std::size_t>(limits.grid_cells))};
    if (!arena.measuring()) slots_[i] = slot;
  }
}

Result<void> check_template(const PartTemplate& part, const Limits& limits) {
  const std::size_t most_points =
      static_cast<std::size_t>(std::min(limits.template_points, ClosestPointGrid::kMaxPoints));
  const auto too_many = [&](const char* what, std::size_t found, std::size_t expected) {
    return failure(ResultCode::kTemplateTooLarge,
                   "template '%s': expected at most %zu %s, found %zu; teach it with fewer", part.name.c_str(),
                   expected, what, found);
  };
  if (part.point_mm.empty()) {
    return failure(ResultCode::kNoTemplate, "template '%s' has no points; teach it again", part.name.c_str());
  }
  if (part.point_mm.size() > most_points) return too_many("points", part.point_mm.size(), most_points);
  if (part.symmetry.elements.size() > PartModel::kMaxSymmetries) {
    return too_many("symmetries", part.symmetry.elements.size(), PartModel::kMaxSymmetries);
  }
  if (part.grasps.size() > PartModel::kMaxGrasps) return too_many("grasps", part.grasps.size(), PartModel::kMaxGrasps);
  return {};
}

Result<void> check_templates(std::span<const PartTemplate> templates, const Limits& limits) {
  if (templates.empty())
    return failure(ResultCode::kNoTemplate, "no template given, expected at least one; teach a part");
  if (templates.size() > static_cast<std::size_t>(limits.templates)) {
    return failure(ResultCode::kLimitExceeded, "expected at most %d templates, found %zu; raise limits.templates",
                   limits.templates, templates.size());
  }
  for (const PartTemplate& part : templates) {
    if (auto ok = check_template(part, limits); !ok) return ok;
  }
  return {};
}

Result<void> ModelStore::load(std::span<const PartTemplate> templates, const GripperShape& gripper) {
  if (auto fits = check_templates(templates, limits_); !fits) return fits;
  count_ = templates.size();
  for (std::size_t i = 0; i < count_; ++i) {
    fill(templates[i], gripper, slots_[i], models_[i]);
    index_surface(slots_[i], trees_[i], models_[i]);
  }
  return {};
}

void ModelStore::index_surface(Slot& slot, std::unique_ptr<ClosestPointTree>& tree, PartModel& model) const {
  tree.reset();
  if (slot.grid.empty()) {
    tree = std::make_unique<ClosestPointTree>(model.surface);
  } else {
    const GridShape shape =
        plan_closest_point_grid(model.box_min_mm, model.box_max_mm, kMarginShare * model.diagonal_mm,
                                0.5 * static_cast<double>(model.spacing_mm), limits_.grid_cells);
    model.grid.build(shape, model.surface, slot.grid);
  }
  model.tree = tree.get();
}

void ModelStore::fill(const PartTemplate& part, const GripperShape& gripper, Slot& slot, PartModel& model) const {
  const std::size_t points = part.point_mm.size();
  const std::vector<std::uint32_t> order = spatial_order(part.point_mm);
  for (std::size_t i = 0; i < points; ++i) slot.surface[i] = {part.point_mm[order[i]], part.normal[order[i]]};
  model.surface = slot.surface.first(points);
  scatter(model.surface, slot.scattered);
  model.fine = block_up(model.surface, static_cast<float>(part.spacing_mm), slot.fine);
  model.coarse = thin_out(model.surface, model.fine, slot.coarse);
  model.scattered = slot.scattered;
  model.spacing_mm = static_cast<float>(part.spacing_mm);
  model.box_min_mm = part.box_min_mm;
  model.box_max_mm = part.box_max_mm;
  model.centre_mm = 0.5 * (part.box_min_mm + part.box_max_mm);
  model.diagonal_mm = (part.box_max_mm - part.box_min_mm).norm();
  search::compute_views(model);
  model.primitive_count = static_cast<int>(std::min<std::size_t>(part.primitives.size(), PartModel::kMaxPrimitives));
  std::copy_n(part.primitives.begin(), model.primitive_count, model.primitives.begin());
  plan_search(part, model);
  // A template asks for more than any part must show, never for less.
  model.required = stricter(Requirements{}, part.requirements.value_or(Requirements{}));
  copy_symmetry(part.symmetry, model);
  model.gripper = part.gripper.value_or(gripper);
  model.grasp_count = static_cast<int>(part.grasps.size());
  for (std::size_t i = 0; i < part.grasps.size(); ++i) {
    GraspPose grasp{part.grasps[i].T_part_gripper, part.grasps[i].opening_mm, true};
    grasp.clear_of_part = result::clear_of_part(grasp, model.surface, model.gripper);
    model.grasps[i] = grasp;
  }
}

}  // namespace beltpick::pipeline
