#include "search/quality.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::search {

float mean_distance_mm(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& T_camera_part,
                       float cap_mm, float give_up_mm) {
  const auto T_part_camera = T_camera_part.inverse();
  const Eigen::Matrix3f rotation = T_part_camera.rotation.cast<float>();
  const Vec3f translation = T_part_camera.translation_mm.cast<float>();
  const float count = static_cast<float>(sample.size());
  const float give_up_sum = give_up_mm * count;
  float sum = 0.0F;
  for (const OrientedPoint& measured : sample) {
    const Vec3f at = rotation * measured.point_mm + translation;
    const OrientedPoint& nearest = model.nearest(at);
    const bool same_side = nearest.normal.dot(rotation * measured.normal) > 0.0F;
    sum += same_side ? std::min(cap_mm, (nearest.point_mm - at).norm()) : cap_mm;
    if (sum > give_up_sum) break;
  }
  return sum / count;
}

}  // namespace beltpick::search
