#include "primitives/cost.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::primitives {
namespace {

constexpr int kLanes = 16;  // sums kept apart, so that the order of addition does not depend on the vector unit
constexpr int kBlock = 256;

// A plane, a cylinder or, with a zero direction, a sphere: the kernels' plain numbers.
struct Shape {
  float px, py, pz, dx, dy, dz, radius, side, threshold, agreement;
};

struct Points {
  const float *x, *y, *z, *nx, *ny, *nz;
};

Shape shape_of(const Model& model, const PrimitiveQuery& query) {
  const Vec3f point_mm = model.point_mm.cast<float>();
  const Vec3f direction = (model.kind == PrimitiveKind::kSphere ? Vec3(Vec3::Zero()) : model.direction).cast<float>();
  return {point_mm.x(),
          point_mm.y(),
          point_mm.z(),
          direction.x(),
          direction.y(),
          direction.z(),
          static_cast<float>(model.radius_mm),
          static_cast<float>(model.side),
          static_cast<float>(threshold_mm2(query)),
          static_cast<float>(least_agreement(query))};
}

BELTPICK_KERNEL void add_plane(const Points& p, const Shape& s, int count, float* sums) {
  for (int i = 0; i < count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int k = i + lane;
      const float e = (p.x[k] - s.px) * s.dx + (p.y[k] - s.py) * s.dy + (p.z[k] - s.pz) * s.dz;
      const float agreement = s.side * (p.nx[k] * s.dx + p.ny[k] * s.dy + p.nz[k] * s.dz);
      const float square = std::min(e * e, s.threshold);
      sums[lane] += agreement >= s.agreement ? square : s.threshold;
    }
  }
}

BELTPICK_KERNEL void add_round(const Points& p, const Shape& s, int count, float* sums) {
  for (int i = 0; i < count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int k = i + lane;
      float x = p.x[k] - s.px, y = p.y[k] - s.py, z = p.z[k] - s.pz;
      const float along = x * s.dx + y * s.dy + z * s.dz;
      x -= along * s.dx, y -= along * s.dy, z -= along * s.dz;
      const float length = std::sqrt(x * x + y * y + z * z);
      const float e = length - s.radius;
      const float agreement = s.side * (x * p.nx[k] + y * p.ny[k] + z * p.nz[k]);
      const float square = std::min(e * e, s.threshold);
      sums[lane] += agreement >= s.agreement * length ? square : s.threshold;
    }
  }
}

double tail_cost(const Cloud& cloud, const Model& model, const PrimitiveQuery& query, int from) {
  const InlierRule rule(query);
  double sum = 0;
  for (int i = from; i < cloud.count; ++i) {
    const Residual r = residual(model, cloud.point(i));
    sum += rule.holds(cloud, i, model, r) ? r.distance_mm * r.distance_mm : rule.threshold_mm2;
  }
  return sum;
}

}  // namespace

double cost_mm2(const Cloud& cloud, const Model& model, const PrimitiveQuery& query, double limit_mm2) {
  const Shape shape = shape_of(model, query);
  const int whole = cloud.count / kLanes * kLanes;
  double total = 0;
  for (int begin = 0; begin < whole && total <= limit_mm2; begin += kBlock) {
    alignas(64) std::array<float, kLanes> sums{};
    const Points points{&cloud.x[begin],  &cloud.y[begin],  &cloud.z[begin],
                        &cloud.nx[begin], &cloud.ny[begin], &cloud.nz[begin]};
    const int count = std::min(kBlock, whole - begin);
    if (model.kind == PrimitiveKind::kPlane) {
      add_plane(points, shape, count, sums.data());
    } else {
      add_round(points, shape, count, sums.data());
    }
    for (const float sum : sums) total += sum;
  }
  return total <= limit_mm2 ? total + tail_cost(cloud, model, query, whole) : total;
}

}  // namespace beltpick::primitives
