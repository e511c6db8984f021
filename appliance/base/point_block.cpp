#include "base/point_block.hpp"

#include <algorithm>

#include "base/kernel.hpp"

namespace beltpick {
namespace {

BELTPICK_KERNEL void move_steps(const PointBlock& from, const FastMotion& m, std::size_t count,
                                PointBlock& __restrict to) {
  for (std::size_t i = 0; i < count; i += PointBlock::kLanes) {
    for (std::size_t k = i; k < i + PointBlock::kLanes; ++k) {
      to.x[k] = m.r[0] * from.x[k] + m.r[1] * from.y[k] + m.r[2] * from.z[k] + m.t_mm[0];
      to.y[k] = m.r[3] * from.x[k] + m.r[4] * from.y[k] + m.r[5] * from.z[k] + m.t_mm[1];
      to.z[k] = m.r[6] * from.x[k] + m.r[7] * from.y[k] + m.r[8] * from.z[k] + m.t_mm[2];
    }
    for (std::size_t k = i; k < i + PointBlock::kLanes; ++k) {
      to.nx[k] = m.r[0] * from.nx[k] + m.r[1] * from.ny[k] + m.r[2] * from.nz[k];
      to.ny[k] = m.r[3] * from.nx[k] + m.r[4] * from.ny[k] + m.r[5] * from.nz[k];
      to.nz[k] = m.r[6] * from.nx[k] + m.r[7] * from.ny[k] + m.r[8] * from.nz[k];
    }
  }
}

}  // namespace

int PointBlock::load(std::span<const OrientedPoint> points) {
  const int count = std::min(static_cast<int>(points.size()), kSize);
  for (int i = 0; i < count; ++i) put(points[static_cast<std::size_t>(i)], i);
  fill_up(count);
  return count;
}

void move_points(const PointBlock& from, const FastMotion& motion, int count, PointBlock& to) {
  move_steps(from, motion, static_cast<std::size_t>(PointBlock::whole_steps(count)), to);
}

}  // namespace beltpick
