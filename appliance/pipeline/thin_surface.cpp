#include "pipeline/thin_surface.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "base/random.hpp"

namespace beltpick::pipeline {
namespace {

// Normals less than 60 degrees apart: a sheet's two sides are thinned each by itself.
constexpr float kSameSide = 0.5F;
constexpr std::uint32_t kBuckets = 1U << 14U;
constexpr std::uint32_t kNone = ~0U;

// The points kept, by the cell of a lattice as wide as they must lie apart. Cells that share a bucket do no harm:
// distances are compared.
class Kept {
 public:
  Kept(std::span<const OrientedPoint> surface, float apart_mm)
      : surface_(surface), apart_mm_(apart_mm), first_(kBuckets, kNone), next_(surface.size(), kNone) {}

  [[nodiscard]] bool any_near(const OrientedPoint& point) const {
    const std::array<int, 3> at = cell(point);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          for (std::uint32_t i = first_[bucket({at[0] + dx, at[1] + dy, at[2] + dz})]; i != kNone; i = next_[i]) {
            if (near(surface_[i], point)) return true;
          }
        }
      }
    }
    return false;
  }

  void add(std::uint32_t index) {
    std::uint32_t& head = first_[bucket(cell(surface_[index]))];
    next_[index] = head;
    head = index;
  }

 private:
  [[nodiscard]] bool near(const OrientedPoint& a, const OrientedPoint& b) const {
    return (a.point_mm - b.point_mm).squaredNorm() < apart_mm_ * apart_mm_ && a.normal.dot(b.normal) > kSameSide;
  }
  [[nodiscard]] std::array<int, 3> cell(const OrientedPoint& point) const {
    const auto along = [&](float mm) { return static_cast<int>(std::floor(mm / apart_mm_)); };
    return {along(point.point_mm.x()), along(point.point_mm.y()), along(point.point_mm.z())};
  }
  static std::uint32_t bucket(const std::array<int, 3>& cell) {
    const auto spread = [](int index, std::uint32_t by) { return static_cast<std::uint32_t>(index) * by; };
    return (spread(cell[0], 73856093U) ^ spread(cell[1], 19349663U) ^ spread(cell[2], 83492791U)) % kBuckets;
  }

  std::span<const OrientedPoint> surface_;
  float apart_mm_;
  std::vector<std::uint32_t> first_;  // of each bucket
  std::vector<std::uint32_t> next_;   // of the same bucket as each point
};

std::vector<bool> choose(std::span<const OrientedPoint> surface, float apart_mm) {
  std::vector<std::uint32_t> order(surface.size());
  std::iota(order.begin(), order.end(), 0U);
  Random random(1);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  Kept kept(surface, apart_mm);
  std::vector<bool> chosen(surface.size(), false);
  for (const std::uint32_t index : order) {
    if (kept.any_near(surface[index])) continue;
    kept.add(index);
    chosen[index] = true;
  }
  return chosen;
}

}  // namespace

std::size_t thin_surface(std::span<const OrientedPoint> surface, float apart_mm, std::span<PointBlock> out) {
  const std::vector<bool> kept = choose(surface, apart_mm);
  std::size_t count = 0;
  for (std::size_t i = 0; i < surface.size() && count < out.size() * PointBlock::kSize; ++i) {
    if (!kept[i]) continue;
    out[count / PointBlock::kSize].put(surface[i], static_cast<int>(count % PointBlock::kSize));
    ++count;
  }
  if (count % PointBlock::kSize != 0)
    out[count / PointBlock::kSize].fill_up(static_cast<int>(count % PointBlock::kSize));
  return count;
}

}  // namespace beltpick::pipeline
