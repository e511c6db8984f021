#include "pipeline/spatial_order.hpp"

#include <algorithm>
#include <numeric>

namespace beltpick::pipeline {
namespace {

constexpr int kBits = 10;

std::uint32_t place_on_curve(const Vec3f& steps) {
  std::uint32_t place = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (int axis = 0; axis < 3; ++axis) place = place << 1U | (static_cast<std::uint32_t>(steps[axis]) >> bit & 1U);
  }
  return place;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3f> point_mm) {
  std::vector<std::uint32_t> order(point_mm.size());
  std::iota(order.begin(), order.end(), 0U);
  if (point_mm.empty()) return order;
  Vec3f low = point_mm.front(), high = low;
  for (const Vec3f& p : point_mm) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const float extent_mm = (high - low).maxCoeff();
  const float per_mm = extent_mm > 0.0F ? static_cast<float>((1 << kBits) - 1) / extent_mm : 0.0F;
  std::vector<std::uint32_t> place(point_mm.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = place_on_curve((point_mm[i] - low) * per_mm);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return place[a] < place[b]; });
  return order;
}

}  // namespace beltpick::pipeline
