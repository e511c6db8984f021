#include "result/grasp_choice.hpp"

#include <algorithm>
#include <cmath>

#include "contract/lens_project.hpp"
#include "contract/result_codes.hpp"
#include "result/equivalents.hpp"
#include "result/gripper_volume.hpp"

namespace beltpick::result {
namespace {

// Kept free round the gripper: the pose, the robot and the measurement are not exact.
constexpr double kClearance_mm = 1.0;
// A stray pixel at a depth edge obstructs nothing; this much surface does.
constexpr double kObstacleArea_mm2 = 3.0;
constexpr double kLeastDescent = 0.5;  // cosine of 60 degrees

struct PixelBox {
  int row_min = 1 << 30, row_max = -1, col_min = 1 << 30, col_max = -1;

  void add(const PixelPosition& at) {
    row_min = std::min(row_min, static_cast<int>(at.row_px));
    row_max = std::max(row_max, static_cast<int>(at.row_px) + 1);
    col_min = std::min(col_min, static_cast<int>(at.column_px));
    col_max = std::max(col_max, static_cast<int>(at.column_px) + 1);
  }
};

bool obstructed(const GripperPose& T_camera_gripper, const GripperVolume& gripper, const Scene& scene) {
  PixelBox box;
  for (const Vec3& corner : gripper.corners()) {
    const Vec3 at = T_camera_gripper * corner;
    if (in_field(scene.lens, at)) box.add(project(scene.lens, at));
  }
  const auto T_gripper_camera = T_camera_gripper.inverse();
  const Eigen::Matrix3f rotation = T_gripper_camera.rotation.cast<float>();
  const Vec3f translation = T_gripper_camera.translation_mm.cast<float>();
  const auto& points = scene.range.point_mm;
  double area = 0.0;
  for (int row = std::max(0, box.row_min); row <= std::min(points.rows - 1, box.row_max); ++row) {
    for (int col = std::max(0, box.col_min); col <= std::min(points.cols - 1, box.col_max); ++col) {
      if (!scene.range.valid(row, col)) continue;
      const Vec3f& point = points(row, col);
      if (!gripper.holds(rotation * point + translation)) continue;
      area += point.z() * point.z() / (scene.lens.fx_px * scene.lens.fy_px);
      if (area >= kObstacleArea_mm2) return true;
    }
  }
  return false;
}

bool meets_belt(const GripperPose& T_camera_gripper, const GripperVolume& gripper, const Scene& scene) {
  if (!scene.belt) return false;
  const auto at = gripper.corners();
  return std::any_of(at.begin(), at.end(),
                     [&](const Vec3& corner) { return scene.belt->height_mm(T_camera_gripper * corner) < 0.0; });
}

bool meets_neighbour(const GripperPose& T_camera_gripper, const GripperVolume& gripper, const Neighbour& neighbour) {
  const PartModel& model = *neighbour.model;
  const auto T_gripper_part = T_camera_gripper.inverse() * neighbour.T_camera_part;
  const double away_mm = gripper.distance_mm(T_gripper_part * model.centre_mm);
  if (away_mm > 0.5 * model.diagonal_mm) return false;
  const Eigen::Matrix3f rotation = T_gripper_part.rotation.cast<float>();
  const Vec3f translation = T_gripper_part.translation_mm.cast<float>();
  return std::any_of(model.surface.begin(), model.surface.end(), [&](const OrientedPoint& point) {
    return gripper.holds(rotation * point.point_mm + translation);
  });
}

// A part that was touched in vain has moved a little, but the same grasp would fail again.
bool was_refused(const GripperPose& T_camera_gripper, std::span<const GripperPose> refused) {
  constexpr double kNear_mm = 10.0;
  constexpr double kNear_rad = 0.35;
  return std::any_of(refused.begin(), refused.end(), [&](const GripperPose& failed) {
    return (failed.translation_mm - T_camera_gripper.translation_mm).norm() < kNear_mm &&
           rotation_between_rad(failed.rotation, T_camera_gripper.rotation) < kNear_rad;
  });
}

}  // namespace

bool clear_of_part(const GraspPose& grasp, std::span<const OrientedPoint> surface, const GripperShape& gripper) {
  const GripperVolume volume(gripper, grasp.opening_mm, 0.0);
  const auto T_gripper_part = grasp.T_part_gripper.inverse();
  return std::none_of(surface.begin(), surface.end(), [&](const OrientedPoint& point) {
    return volume.holds((T_gripper_part * point.point_mm.cast<double>()).cast<float>());
  });
}

Reach reach(const PartModel& model, const GraspPose& grasp, const PartPose& T_camera_part, const Surroundings& around) {
  const Scene& scene = around.scene;
  const GripperPose T_camera_gripper = T_camera_part * grasp.T_part_gripper;
  const Vec3 up = scene.belt ? scene.belt->normal : Vec3(-T_camera_part.translation_mm.normalized());
  if (-T_camera_gripper.rotation.col(2).dot(up) < kLeastDescent) return Reach::kFromBelow;
  if (!grasp.clear_of_part) return Reach::kMeetsPart;
  const GripperVolume gripper(model.gripper, grasp.opening_mm, kClearance_mm);
  if (meets_belt(T_camera_gripper, gripper, scene)) return Reach::kMeetsBelt;
  if (was_refused(T_camera_gripper, around.refused)) return Reach::kRefused;
  if (obstructed(T_camera_gripper, gripper, scene)) return Reach::kObstructed;
  const bool hidden = std::any_of(around.neighbours.begin(), around.neighbours.end(), [&](const Neighbour& neighbour) {
    return meets_neighbour(T_camera_gripper, gripper, neighbour);
  });
  return hidden ? Reach::kNeighbour : Reach::kReachable;
}

GraspChoice choose_grasp(const PartModel& model, const PartPose& T_camera_part, const Surroundings& around) {
  GraspChoice choice;
  choice.T_camera_part = T_camera_part;
  const std::span grasps(model.grasps.data(), static_cast<std::size_t>(model.grasp_count));
  bool asked_for = true;
  any_equivalent(model, T_camera_part, [&](const PartPose& pose) {
    for (std::size_t i = 0; i < grasps.size(); ++i) {
      const Reach found = reach(model, grasps[i], pose, around);
      if (asked_for) ++choice.findings[static_cast<std::size_t>(found)];
      if (found != Reach::kReachable) continue;
      choice.index = static_cast<int>(i);
      choice.T_camera_part = pose;
      return true;
    }
    asked_for = false;
    return false;
  });
  return choice;
}

Error no_grasp_reason(const GraspChoice& choice, int grasp_count) {
  if (grasp_count == 0) {
    return failure(ResultCode::kNoGrasp, "the template has no grasp; teach it with --grasps").error();
  }
  const int beside = choice.count(Reach::kObstructed) + choice.count(Reach::kNeighbour);
  const bool comes_free = beside > 0;
  return failure(comes_free ? ResultCode::kObstructed : ResultCode::kNoGrasp,
                 "of %d grasps none can be reached: %d from below or too flat, %d would meet the belt, %d the part "
                 "itself, %d what lies beside it, %d failed before; %s",
                 grasp_count, choice.count(Reach::kFromBelow), choice.count(Reach::kMeetsBelt),
                 choice.count(Reach::kMeetsPart), beside, choice.count(Reach::kRefused),
                 comes_free ? "it comes free when its neighbour is picked" : "teach further grasps")
      .error();
}

}  // namespace beltpick::result
