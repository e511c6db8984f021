// ClosestPointGrid: for every cell of a box round a point set, the index of the point nearest to the cell's centre, so
// that "which point of the part is nearest to here" is one memory access.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/pose.hpp"
#include "base/stages.hpp"

namespace beltpick {

// Where the cells lie.
struct GridShape {
  Vec3f origin_mm = Vec3f::Zero();  // the corner of cell (0, 0, 0)
  float cell_mm = 1.0F;
  std::array<int, 3> cells{};

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(cells[2]);
  }
};

// The finest grid of cubic cells that covers the box and `margin_mm` round it with at most `max_cells`; never finer
// than `finest_mm`.
GridShape plan_closest_point_grid(const Vec3& box_min_mm, const Vec3& box_max_mm, double margin_mm, double finest_mm,
                                  int max_cells);

class ClosestPointGrid {
 public:
  // Indices are 16 bit.
  static constexpr int kMaxPoints = 65535;

  // Fills `storage` (shape.count() elements, the caller's) by passing on nearest points from cell to cell, once in each
  // direction along each axis (Danielsson's vector distance propagation, here with the true points instead of cell
  // centres). At least one and at most kMaxPoints points.
  void build(const GridShape& shape, std::span<const OrientedPoint> points, std::span<std::uint16_t> storage);

  // The index of the nearest point, up to about a cell's diagonal; outside the box that of the nearest cell.
  [[nodiscard]] std::uint16_t nearest(const Vec3f& at_mm) const {
    const Vec3f cell = (at_mm - shape_.origin_mm) * per_cell_;
    const auto clamped = [&](int axis) {
      const float inside = std::clamp(cell[axis], 0.0F, static_cast<float>(shape_.cells[axis] - 1));
      return static_cast<int>(inside);
    };
    return nearest_[(clamped(2) * static_cast<std::int64_t>(shape_.cells[1]) + clamped(1)) * shape_.cells[0] +
                    clamped(0)];
  }

  // The same for a cell: x + cells[0] (y + cells[1] z).
  [[nodiscard]] std::uint16_t at_cell(int cell) const { return nearest_[cell]; }

  // Has the memory fetch what at_cell() will read.
  void will_ask(int cell) const { __builtin_prefetch(nearest_ + cell); }

  [[nodiscard]] const GridShape& shape() const { return shape_; }
  [[nodiscard]] float cells_per_mm() const { return per_cell_; }

 private:
  GridShape shape_;
  float per_cell_ = 1.0F;
  const std::uint16_t* nearest_ = nullptr;
};

}  // namespace beltpick
