#include "result/rivalry.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::result {
namespace {

// Asks whether measured points lie on a part.
class OnSurface {
 public:
  OnSurface(const Rival& rival, const Scene& scene)
      : model_(rival.model),
        tolerance_mm_(static_cast<float>(surface_tolerance_mm(scene, rival.model.spacing_mm))),
        aside_mm_(1.5F * rival.model.spacing_mm + tolerance_mm_) {
    const auto T_part_camera = rival.T_camera_part.inverse();
    rotation_ = T_part_camera.rotation.cast<float>();
    translation_ = T_part_camera.translation_mm.cast<float>();
  }

  [[nodiscard]] bool holds(const Vec3f& measured_mm) const {
    const Vec3f at = rotation_ * measured_mm + translation_;
    if (model_.outside_box_mm(at) > aside_mm_ + 0.01F) return false;
    const OrientedPoint& nearest = model_.nearest(at);
    const Vec3f apart = at - nearest.point_mm;
    return std::abs(nearest.normal.dot(apart)) < tolerance_mm_ && apart.squaredNorm() < aside_mm_ * aside_mm_;
  }

 private:
  const PartModel& model_;
  float tolerance_mm_;
  float aside_mm_;
  Eigen::Matrix3f rotation_;
  Vec3f translation_;
};

}  // namespace

Rivalry compare(const Rival& first, const Rival& second, const Scene& scene, const Region& region, int step) {
  const OnSurface on_first(first, scene);
  const OnSurface on_second(second, scene);
  Rivalry rivalry;
  for (int row = std::max(0, region.row_min); row <= std::min(scene.range.point_mm.rows - 1, region.row_max);
       row += step) {
    for (int col = std::max(0, region.col_min); col <= std::min(scene.range.point_mm.cols - 1, region.col_max);
         col += step) {
      if (scene.labels(row, col) == 0 || !scene.range.valid(row, col)) continue;
      const Vec3f& measured = scene.range.point_mm(row, col);
      const bool one = on_first.holds(measured);
      const bool two = on_second.holds(measured);
      rivalry.both += one && two ? 1 : 0;
      rivalry.only_first += one && !two ? 1 : 0;
      rivalry.only_second += two && !one ? 1 : 0;
    }
  }
  return rivalry;
}

bool prevails(const Rivalry& rivalry) {
  // Along edges a pixel falls to the one or the other by chance: four standard deviations of that, and a few pixels.
  const double lead = rivalry.only_first - rivalry.only_second;
  const double chance = std::sqrt(static_cast<double>(rivalry.only_first + rivalry.only_second));
  return lead > 10.0 + 4.0 * chance;
}

}  // namespace beltpick::result
