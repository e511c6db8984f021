#include "result/grasp_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "contract/lens_project.hpp"

namespace beltpick::result {
namespace {

// Kept free round the jaws: the pose, the robot and the measurement are not exact.
constexpr double kClearance_mm = 1.0;
// A stray pixel at a depth edge obstructs nothing; this much surface does.
constexpr double kObstacleArea_mm2 = 3.0;
constexpr double kLeastDescent = 0.5;  // cosine of 60 degrees

// The jaws as one frame-aligned test in the gripper's frame.
struct JawVolume {
  double inner_mm, outer_mm, half_width_mm, length_mm, tip_mm;

  JawVolume(const GraspPose& grasp, const GripperShape& gripper, double clearance_mm)
      : inner_mm(0.5 * grasp.opening_mm - clearance_mm),
        outer_mm(0.5 * grasp.opening_mm + gripper.jaw_thickness_mm + clearance_mm),
        half_width_mm(0.5 * gripper.jaw_width_mm + clearance_mm),
        length_mm(gripper.reach_mm),
        tip_mm(gripper.tip_mm + clearance_mm) {}

  [[nodiscard]] bool holds(const Vec3& at) const {
    const double x = std::abs(at.x());
    return x > inner_mm && x < outer_mm && std::abs(at.y()) < half_width_mm && at.z() > -length_mm && at.z() < tip_mm;
  }
};

struct Box {
  int row_min = 1 << 30, row_max = -1, col_min = 1 << 30, col_max = -1;

  void add(const PixelPosition& at) {
    row_min = std::min(row_min, static_cast<int>(at.row_px));
    row_max = std::max(row_max, static_cast<int>(at.row_px) + 1);
    col_min = std::min(col_min, static_cast<int>(at.column_px));
    col_max = std::max(col_max, static_cast<int>(at.column_px) + 1);
  }
};

std::array<Vec3, 8> corners(const GripperPose& T_camera_gripper, const JawVolume& jaws) {
  std::array<Vec3, 8> at;
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] = T_camera_gripper * Vec3((i & 1U) != 0 ? jaws.outer_mm : -jaws.outer_mm,
                                    (i & 2U) != 0 ? jaws.half_width_mm : -jaws.half_width_mm,
                                    (i & 4U) != 0 ? jaws.tip_mm : -jaws.length_mm);
  }
  return at;
}

double obstacle_area_mm2(const GripperPose& T_camera_gripper, const JawVolume& jaws, const Scene& scene) {
  Box box;
  for (const Vec3& corner : corners(T_camera_gripper, jaws)) {
    if (in_field(scene.lens, corner)) box.add(project(scene.lens, corner));
  }
  const auto T_gripper_camera = T_camera_gripper.inverse();
  const auto& points = scene.range.point_mm;
  double area = 0.0;
  for (int row = std::max(0, box.row_min); row <= std::min(points.rows - 1, box.row_max); ++row) {
    for (int col = std::max(0, box.col_min); col <= std::min(points.cols - 1, box.col_max); ++col) {
      if (!scene.range.valid(row, col)) continue;
      const Vec3 point = points(row, col).cast<double>();
      if (jaws.holds(T_gripper_camera * point)) area += point.z() * point.z() / (scene.lens.fx_px * scene.lens.fy_px);
    }
  }
  return area;
}

bool meets_belt(const GripperPose& T_camera_gripper, const JawVolume& jaws, const Scene& scene) {
  if (!scene.belt) return false;
  const auto at = corners(T_camera_gripper, jaws);
  return std::any_of(at.begin(), at.end(), [&](const Vec3& corner) { return scene.belt->height_mm(corner) < 0.0; });
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
  const JawVolume jaws(grasp, gripper, 0.0);
  const auto T_gripper_part = grasp.T_part_gripper.inverse();
  return std::none_of(surface.begin(), surface.end(), [&](const OrientedPoint& point) {
    return jaws.holds(T_gripper_part * point.point_mm.cast<double>());
  });
}

Reach reach(const GraspPose& grasp, const PartPose& T_camera_part, const Scene& scene, const GripperShape& gripper) {
  const GripperPose T_camera_gripper = T_camera_part * grasp.T_part_gripper;
  const Vec3 up = scene.belt ? scene.belt->normal : Vec3(-T_camera_part.translation_mm.normalized());
  if (-T_camera_gripper.rotation.col(2).dot(up) < kLeastDescent) return Reach::kFromBelow;
  const JawVolume jaws(grasp, gripper, kClearance_mm);
  if (meets_belt(T_camera_gripper, jaws, scene)) return Reach::kFromBelow;
  return obstacle_area_mm2(T_camera_gripper, jaws, scene) < kObstacleArea_mm2 ? Reach::kReachable : Reach::kObstructed;
}

GraspChoice choose_grasp(const PartModel& model, const PartPose& T_camera_part, const Scene& scene,
                         const GripperShape& gripper, std::span<const GripperPose> refused) {
  GraspChoice choice;
  for (int i = 0; i < model.grasp_count; ++i) {
    const GraspPose& grasp = model.grasps[static_cast<std::size_t>(i)];
    if (!grasp.clear_of_part) continue;
    const Reach found = reach(grasp, T_camera_part, scene, gripper);
    if (found == Reach::kReachable && !was_refused(T_camera_part * grasp.T_part_gripper, refused)) {
      choice.index = i;
      return choice;
    }
    choice.any_obstructed = choice.any_obstructed || found != Reach::kFromBelow;
  }
  return choice;
}

}  // namespace beltpick::result
