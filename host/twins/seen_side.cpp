#include "twins/seen_side.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace beltpick::twins {
namespace {

constexpr double kFar_mm = 5000.0;
constexpr double kCellSpacings = 1.8;   // so wide that the far side does not show through
constexpr double kDepthSpacings = 2.5;  // what lies no farther behind the front of its cell is in sight as well
constexpr float kLeastFacing = 0.26F;

}  // namespace

PartPose look_along(const PartModel& model, const Vec3& sight) {
  const Mat3 rotation = Eigen::Quaterniond::FromTwoVectors(sight, Vec3::UnitZ()).toRotationMatrix();
  return {rotation, Vec3(0.0, 0.0, kFar_mm) - rotation * model.centre_mm};
}

std::vector<OrientedPoint> seen_side(const PartModel& model, const PartPose& T_camera_part) {
  const double cell_mm = kCellSpacings * static_cast<double>(model.spacing_mm);
  const int side = static_cast<int>(1.1 * model.diagonal_mm / cell_mm) + 3;
  const Vec3 centre = T_camera_part * model.centre_mm;
  const Eigen::Matrix3f rotation = T_camera_part.rotation.cast<float>();
  const Vec3f translation = T_camera_part.translation_mm.cast<float>();
  std::vector<OrientedPoint> moved;
  std::vector<std::size_t> cell;
  std::vector<float> front(static_cast<std::size_t>(side) * static_cast<std::size_t>(side),
                           std::numeric_limits<float>::max());
  for (const OrientedPoint& point : model.surface) {
    const Vec3f at = rotation * point.point_mm + translation;
    const int col =
        std::clamp(static_cast<int>((static_cast<double>(at.x()) - centre.x()) / cell_mm + side / 2.0), 0, side - 1);
    const int row =
        std::clamp(static_cast<int>((static_cast<double>(at.y()) - centre.y()) / cell_mm + side / 2.0), 0, side - 1);
    const std::size_t index =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(col);
    front[index] = std::min(front[index], at.z());
    moved.push_back({at, rotation * point.normal});
    cell.push_back(index);
  }
  const auto behind = static_cast<float>(kDepthSpacings * static_cast<double>(model.spacing_mm));
  std::vector<OrientedPoint> seen;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (-moved[i].normal.z() > kLeastFacing && moved[i].point_mm.z() < front[cell[i]] + behind)
      seen.push_back(moved[i]);
  }
  return seen;
}

double area_off_mm2(const std::vector<OrientedPoint>& seen, double spacing_mm, const PartModel& part,
                    const PartPose& T_camera_part, double tolerance_mm, double enough_mm2) {
  const auto T_part_camera = T_camera_part.inverse();
  const Eigen::Matrix3f rotation = T_part_camera.rotation.cast<float>();
  const Vec3f translation = T_part_camera.translation_mm.cast<float>();
  const auto tolerance = static_cast<float>(tolerance_mm);
  const float aside = 1.5F * part.spacing_mm + tolerance;
  double area_mm2 = 0.0;
  for (const OrientedPoint& point : seen) {
    const Vec3f at = rotation * point.point_mm + translation;
    const OrientedPoint& nearest = part.nearest(at);
    const Vec3f apart = at - nearest.point_mm;
    if (std::abs(nearest.normal.dot(apart)) < tolerance && apart.squaredNorm() < aside * aside) continue;
    area_mm2 += spacing_mm * spacing_mm * static_cast<double>(-point.normal.z());
    if (area_mm2 >= enough_mm2) break;
  }
  return area_mm2;
}

}  // namespace beltpick::twins
