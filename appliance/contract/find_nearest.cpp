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

void find_nearest(const PartModel& model, const PointBlock& at_part, int count, PointBlock& nearest) {
  if (model.tree != nullptr) {
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      nearest.put(model.surface[model.tree->nearest({at_part.x[k], at_part.y[k], at_part.z[k]})], i);
    }
  } else {
    alignas(64) std::array<int, PointBlock::kSize> cell;
    find_cells(at_part, Cells(model.grid), static_cast<std::size_t>(PointBlock::whole_steps(count)), cell.data());
    // All indices first: they come from far memory, and so they are waited for together.
    std::array<std::uint16_t, PointBlock::kSize> index;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) index[k] = model.grid.at_cell(cell[k]);
    for (int i = 0; i < count; ++i) nearest.put(model.surface[index[static_cast<std::size_t>(i)]], i);
  }
  nearest.fill_up(count);
}

}  // namespace beltpick
