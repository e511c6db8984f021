#include "primitives/model.hpp"

#include <array>
#include <bit>
#include <cmath>

#include "base/units.hpp"

namespace beltpick::primitives {

double least_agreement(const PrimitiveQuery& query) {
  return query.use_normals ? std::cos(query.normal_angle_max_rad) : -2.0;
}

namespace {

// Counts along a line in equal bins, to find where the outer 1 % begin without sorting.
class Histogram {
 public:
  Histogram(double low, double high) : low_(low), width_(std::max(high - low, 1e-9) / kBins) {}
  void add(double value) {
    ++counts_[std::clamp(static_cast<int>((value - low_) / width_), 0, kBins - 1)];
    ++total_;
  }
  // The value below which `share` of the counts lie.
  [[nodiscard]] double quantile(double share) const {
    double below = 0;
    for (int bin = 0; bin < kBins; ++bin) {
      const double next = below + counts_[bin];
      if (next >= share * total_ && counts_[bin] > 0) {
        return low_ + width_ * (bin + (share * total_ - below) / counts_[bin]);
      }
      below = next;
    }
    return low_ + width_ * kBins;
  }

 private:
  static constexpr int kBins = 512;
  double low_, width_;
  std::array<int, kBins> counts_{};
  int total_ = 0;
};

// Angles in 72 sectors of 5 degrees: the arc is what remains of the turn besides the largest gap.
class Sectors {
 public:
  void add(double angle_rad) {
    const int sector = static_cast<int>((angle_rad / kPi + 1.0) * 0.5 * kSectors);
    seen_[std::clamp(sector, 0, kSectors - 1)] = true;
  }
  [[nodiscard]] double arc_rad() const {
    int gap = 0, largest = 0;
    for (int i = 0; i < 2 * kSectors; ++i) {
      gap = seen_[i % kSectors] ? 0 : gap + 1;
      largest = std::max(largest, gap);
    }
    return 2 * kPi * (kSectors - std::min(largest, kSectors)) / kSectors;
  }

 private:
  static constexpr int kSectors = 72;
  std::array<bool, kSectors> seen_{};
};

}  // namespace

Support support_of(const Cloud& cloud, const Model& model, const PrimitiveQuery& query) {
  Support support;
  const InlierRule rule(query);
  double low_mm = 1e30, high_mm = -1e30, sum_mm2 = 0;
  for (int i = 0; i < cloud.count; ++i) {
    const Vec3 point_mm = cloud.point(i);
    const Residual r = residual(model, point_mm);
    if (!rule.holds(cloud, i, model, r)) continue;
    const double along_mm = (point_mm - model.point_mm).dot(model.direction);
    low_mm = std::min(low_mm, along_mm), high_mm = std::max(high_mm, along_mm);
    sum_mm2 += r.distance_mm * r.distance_mm;
    support.centroid_mm += point_mm;
    ++support.inliers;
  }
  if (support.inliers == 0) return support;
  support.centroid_mm /= support.inliers;
  support.rms_mm = std::sqrt(sum_mm2 / support.inliers);
  if (model.kind != PrimitiveKind::kCylinder) return support;

  Histogram along(low_mm, high_mm);
  Sectors about;
  const Vec3 side = model.direction.unitOrthogonal(), third = model.direction.cross(side);
  for (int i = 0; i < cloud.count; ++i) {
    if (!rule.holds(cloud, i, model, residual(model, cloud.point(i)))) continue;
    const Vec3 offset_mm = cloud.point(i) - model.point_mm;
    along.add(offset_mm.dot(model.direction));
    about.add(std::atan2(offset_mm.dot(third), offset_mm.dot(side)));
  }
  const double first_mm = along.quantile(0.01), last_mm = along.quantile(0.99);
  support.extent_mm = last_mm - first_mm;
  support.middle_mm = 0.5 * (first_mm + last_mm);
  support.arc_rad = about.arc_rad();
  return support;
}

}  // namespace beltpick::primitives
