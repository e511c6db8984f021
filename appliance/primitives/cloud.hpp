// Cloud: the points under search as one array a coordinate, about their centroid, as the cost kernel wants them.
#pragma once

#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"

namespace beltpick::primitives {

struct Cloud {
  std::span<float> x, y, z;     // mm, relative to origin_mm
  std::span<float> nx, ny, nz;  // unit normals
  Vec3 origin_mm = Vec3::Zero();
  int count = 0;

  Cloud(Arena& arena, int max_points) {
    for (std::span<float>* axis : {&x, &y, &z, &nx, &ny, &nz}) {
      *axis = arena.take<float>("primitives points", static_cast<std::size_t>(max_points));
    }
  }

  [[nodiscard]] Vec3 point(int i) const { return {x[i], y[i], z[i]}; }
  [[nodiscard]] Vec3 normal(int i) const { return {nx[i], ny[i], nz[i]}; }

  void load(std::span<const OrientedPoint> points) {
    count = static_cast<int>(std::min(points.size(), x.size()));
    origin_mm.setZero();
    for (int i = 0; i < count; ++i) origin_mm += points[i].point_mm.cast<double>();
    if (count > 0) origin_mm /= count;
    for (int i = 0; i < count; ++i) {
      const Vec3f local_mm = (points[i].point_mm.cast<double>() - origin_mm).cast<float>();
      x[i] = local_mm.x(), y[i] = local_mm.y(), z[i] = local_mm.z();
      nx[i] = points[i].normal.x(), ny[i] = points[i].normal.y(), nz[i] = points[i].normal.z();
    }
  }

  void copy_point(int from, int to) {
    x[to] = x[from], y[to] = y[from], z[to] = z[from];
    nx[to] = nx[from], ny[to] = ny[from], nz[to] = nz[from];
  }
};

}  // namespace beltpick::primitives
