#include "contract/find_nearest.hpp"

#include "base/kernel.hpp"

namespace beltpick {
namespace {

// The grid's plain numbers.
struct Cells {
  float origin[3];
  float per_mm;
  float last[3];
  int row, slice;  // cells of

  explicit Cells(const ClosestPointGrid& grid) : per_mm(grid.cells_per_mm()) {
    const GridShape& shape = grid.shape();
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = shape.origin_mm[axis];
      last[axis] = static_cast<float>(shape.cells[static_cast<std::size_t>(axis)] - 1);
    }
    row = shape.cells[0];
    slice = shape.cells[0] * shape.cells[1];
  }
};

[[gnu::always_inline]] inline int cell_of(float at, float origin, float per_mm, float last) {
  const float cell = (at - origin) * per_mm;
  const float inside = cell > 0.0F ? cell : 0.0F;
  return static_cast<int>(inside < last ? inside : last);
}

BELTPICK_KERNEL void find_cells(const PointBlock& at, const Cells& c, std::size_t count, int* __restrict cell) {
  for (std::size_t i = 0; i < count; i += PointBlock::kLanes) {
    for (std::size_t k = i; k < i + PointBlock::kLanes; ++k) {
      const int x = cell_of(at.x[k], c.origin[0], c.per_mm, c.last[0]);
      const int y = cell_of(at.y[k], c.origin[1], c.per_mm, c.last[1]);
      const int z = cell_of(at.z[k], c.origin[2], c.per_mm, c.last[2]);
      cell[k] = z * c.slice + y * c.row + x;
    }
  }
}

}  // namespace

void NearestQuery::begin(const PartModel& model, const PointBlock& at_part, int count) {
  if (model.tree != nullptr) return;
  find_cells(at_part, Cells(model.grid), static_cast<std::size_t>(PointBlock::whole_steps(count)), cell_.data());
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) model.grid.will_ask(cell_[k]);
}

void NearestQuery::go_on(const PartModel& model, int count) {
  if (model.tree != nullptr) return;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    index_[k] = model.grid.at_cell(cell_[k]);
    __builtin_prefetch(&model.surface[index_[k]]);
  }
}

void NearestQuery::finish(const PartModel& model, const PointBlock& at_part, int count, PointBlock& nearest) const {
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::size_t index =
        model.tree == nullptr ? index_[k] : model.tree->nearest({at_part.x[k], at_part.y[k], at_part.z[k]});
    nearest.put(model.surface[index], i);
  }
  nearest.fill_up(count);
}

void find_nearest(const PartModel& model, const PointBlock& at_part, int count, PointBlock& nearest) {
  NearestQuery query;
  query.begin(model, at_part, count);
  query.go_on(model, count);
  query.finish(model, at_part, count, nearest);
}

}  // namespace beltpick
