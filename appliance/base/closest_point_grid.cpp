#include "base/closest_point_grid.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

namespace beltpick {
namespace {

constexpr std::uint16_t kNone = 65535;

// Passes nearest points from one line, row or slice of cells to the next.
class Propagation {
 public:
  Propagation(const GridShape& shape, std::span<const OrientedPoint> points, std::span<std::uint16_t> nearest)
      : shape_(shape), points_(points), nearest_(nearest) {}

  // Every occupied cell starts with its own most central point.
  void seed() {
    std::fill(nearest_.begin(), nearest_.end(), kNone);
    const Vec3f last(static_cast<float>(shape_.cells[0] - 1), static_cast<float>(shape_.cells[1] - 1),
                     static_cast<float>(shape_.cells[2] - 1));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec3f cell = ((points_[i].point_mm - shape_.origin_mm) / shape_.cell_mm).cwiseMax(0.0F).cwiseMin(last);
      const int x = static_cast<int>(cell.x());
      const int y = static_cast<int>(cell.y());
      const int z = static_cast<int>(cell.z());
      offer(at(x, y, z), static_cast<std::uint16_t>(i), centre(x, y, z));
    }
  }

  void run() {
    const int slices = shape_.cells[2];
    for (int z = 0; z < slices; ++z) sweep_slice(z, z - 1);
    for (int z = slices - 1; z >= 0; --z) sweep_slice(z, z + 1);
  }

 private:
  void sweep_slice(int z, int from_z) {
    const int rows = shape_.cells[1];
    if (from_z >= 0 && from_z < shape_.cells[2]) {
      for (int y = 0; y < rows; ++y) take_line(y, z, y, from_z);
    }
    for (int y = 0; y < rows; ++y) sweep_line(y, z, y - 1);
    for (int y = rows - 1; y >= 0; --y) sweep_line(y, z, y + 1);
  }

  void sweep_line(int y, int z, int from_y) {
    if (from_y >= 0 && from_y < shape_.cells[1]) take_line(y, z, from_y, z);
    const int columns = shape_.cells[0];
    for (int x = 1; x < columns; ++x) offer(at(x, y, z), nearest_[at(x - 1, y, z)], centre(x, y, z));
    for (int x = columns - 2; x >= 0; --x) offer(at(x, y, z), nearest_[at(x + 1, y, z)], centre(x, y, z));
  }

  void take_line(int y, int z, int from_y, int from_z) {
    for (int x = 0; x < shape_.cells[0]; ++x) offer(at(x, y, z), nearest_[at(x, from_y, from_z)], centre(x, y, z));
  }

  void offer(std::size_t cell, std::uint16_t candidate, const Vec3f& centre_mm) {
    const std::uint16_t held = nearest_[cell];
    if (candidate == kNone || candidate == held) return;
    if (held == kNone || distance2(candidate, centre_mm) < distance2(held, centre_mm)) nearest_[cell] = candidate;
  }

  [[nodiscard]] float distance2(std::uint16_t point, const Vec3f& centre_mm) const {
    return (points_[point].point_mm - centre_mm).squaredNorm();
  }
  [[nodiscard]] std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(shape_.cells[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(shape_.cells[0]) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] Vec3f centre(int x, int y, int z) const {
    return shape_.origin_mm + shape_.cell_mm * Vec3f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F,
                                                     static_cast<float>(z) + 0.5F);
  }

  const GridShape& shape_;
  std::span<const OrientedPoint> points_;
  std::span<std::uint16_t> nearest_;
};

}  // namespace

GridShape plan_closest_point_grid(const Vec3& box_min_mm, const Vec3& box_max_mm, double margin_mm, double finest_mm,
                                  int max_cells) {
  const Vec3 extent = box_max_mm - box_min_mm + Vec3::Constant(2.0 * margin_mm);
  GridShape shape;
  double cell = std::max(finest_mm, std::cbrt(extent.prod() / max_cells));
  for (;; cell *= 1.02) {
    for (int axis = 0; axis < 3; ++axis)
      shape.cells[axis] = std::max(1, static_cast<int>(std::ceil(extent[axis] / cell)));
    if (shape.count() <= static_cast<std::size_t>(max_cells)) break;
  }
  shape.cell_mm = static_cast<float>(cell);
  shape.origin_mm = (box_min_mm - Vec3::Constant(margin_mm)).cast<float>();
  return shape;
}

void ClosestPointGrid::build(const GridShape& shape, std::span<const OrientedPoint> points,
                             std::span<std::uint16_t> storage) {
  shape_ = shape;
  per_cell_ = 1.0F / shape.cell_mm;
  nearest_ = storage.data();
  Propagation propagation(shape, points, storage.first(shape.count()));
  propagation.seed();
  propagation.run();
}

}  // namespace beltpick
