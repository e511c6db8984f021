// PointBlock: some dozens of oriented points as one array a coordinate, as vector units want them.
#pragma once

#include <array>
#include <span>

#include "base/pose.hpp"
#include "base/stages.hpp"

namespace beltpick {

struct PointBlock {
  static constexpr int kLanes = 16;  // work goes in steps of so many; the elements behind the last point hold zeros
  static constexpr int kSize = 64;
  using Row = std::array<float, kSize>;

  alignas(64) Row x, y, z;     // mm
  alignas(64) Row nx, ny, nz;  // unit normals

  // Takes at most kSize points; returns how many.
  int load(std::span<const OrientedPoint> points);

  void put(const OrientedPoint& point, int at) {
    const auto k = static_cast<std::size_t>(at);
    x[k] = point.point_mm.x(), y[k] = point.point_mm.y(), z[k] = point.point_mm.z();
    nx[k] = point.normal.x(), ny[k] = point.normal.y(), nz[k] = point.normal.z();
  }
  // Zeros from `count` to the next whole step.
  void fill_up(int count) {
    for (int i = count; i < whole_steps(count); ++i) put({Vec3f::Zero(), Vec3f::Zero()}, i);
  }

  static constexpr int whole_steps(int count) { return (count + kLanes - 1) / kLanes * kLanes; }
  static constexpr std::size_t blocks_for(std::size_t points) { return (points + kSize - 1) / kSize; }
};

// A rigid motion's plain numbers, in single precision: rotation row by row, then translation.
struct FastMotion {
  std::array<float, 9> r;
  std::array<float, 3> t_mm;

  template <class To, class From>
  explicit FastMotion(const Pose<To, From>& pose) {
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col)
        r[static_cast<std::size_t>(3 * row + col)] = static_cast<float>(pose.rotation(row, col));
      t_mm[static_cast<std::size_t>(row)] = static_cast<float>(pose.translation_mm[row]);
    }
  }
  [[nodiscard]] Vec3f operator*(const Vec3f& at) const {
    return {r[0] * at.x() + r[1] * at.y() + r[2] * at.z() + t_mm[0],
            r[3] * at.x() + r[4] * at.y() + r[5] * at.z() + t_mm[1],
            r[6] * at.x() + r[7] * at.y() + r[8] * at.z() + t_mm[2]};
  }
};

// Writes the first `count` points of `from` to `to` as `motion` moves them; the same bits on every vector unit.
void move_points(const PointBlock& from, const FastMotion& motion, int count, PointBlock& to);

}  // namespace beltpick
