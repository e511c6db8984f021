#include "pipeline/neighbourhood.hpp"

#include <algorithm>

namespace beltpick::pipeline {

Vec3f highest_point_mm(std::span<const OrientedPoint> sample, const std::optional<Plane>& belt) {
  const auto height = [&](const OrientedPoint& point) {
    const Vec3 place = point.point_mm.cast<double>();
    return belt ? belt->height_mm(place) : -place.z();
  };
  return std::max_element(sample.begin(), sample.end(),
                          [&](const auto& a, const auto& b) { return height(a) < height(b); })
      ->point_mm;
}

Neighbourhood gather_round(std::span<OrientedPoint> sample, const Vec3f& centre_mm, float radius_mm) {
  const auto distance = [&](const OrientedPoint& point) { return (point.point_mm - centre_mm).norm(); };
  const Vec3f farthest_mm = std::max_element(sample.begin(), sample.end(), [&](const auto& a, const auto& b) {
                              return distance(a) < distance(b);
                            })->point_mm;
  const auto end = std::partition(sample.begin(), sample.end(), [&](const auto& p) { return distance(p) < radius_mm; });
  return {static_cast<std::size_t>(end - sample.begin()), farthest_mm};
}

}  // namespace beltpick::pipeline
