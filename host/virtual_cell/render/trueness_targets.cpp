#include "virtual_cell/render/trueness_targets.hpp"

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "virtual_cell/render/target_shapes.hpp"

namespace beltpick::virtual_cell {
namespace {

using BeltPose = Pose<frame::Belt, frame::Part>;

constexpr double kHighestMm = 100.0;
constexpr double kPlaneThicknessMm = 3.0;
constexpr int kTries = 20'000;

// Whether camera and projector both reach a point of the belt frame.
bool in_view(const Rig& rig, const Vec3& point_belt_mm) {
  constexpr double kMarginPx = 5.0;
  const Vec3 seen = rig.T_camera_belt * point_belt_mm;
  const auto within = [](const RichLens& lens, const Eigen::Vector2d& pixel) {
    return pixel.x() >= kMarginPx && pixel.x() <= lens.width - 1 - kMarginPx && pixel.y() >= kMarginPx &&
           pixel.y() <= lens.height - 1 - kMarginPx;
  };
  return within(rig.camera, rig.camera.project(seen)) &&
         within(rig.projector, rig.projector.project(rig.T_projector_camera * seen));
}

// The point of the belt, or of a plane above it, that a pixel sees.
Vec3 on_belt(const Rig& rig, double share_x, double share_y, double height_mm = 0.0) {
  const Vec3 ray = rig.camera.ray({share_x * (rig.camera.width - 1), share_y * (rig.camera.height - 1)});
  const Vec3 up = rig.T_camera_belt.rotation.col(2);
  return rig.T_camera_belt.inverse() *
         Vec3(ray * ((up.dot(rig.T_camera_belt.translation_mm) + height_mm) / up.dot(ray)));
}

Vec3 random_place(const Rig& rig, Random& random) {
  const double x = random.uniform(0.05, 0.95);
  const double y = random.uniform(0.05, 0.95);
  return on_belt(rig, x, y);
}

TrueTarget plane_target(const Rig& rig, int instance, const Vec3& point_belt_mm, const Vec3& normal_belt,
                        double height_mm) {
  TrueTarget target;
  target.kind = TrueTarget::Kind::kPlane;
  target.instance = instance;
  target.point_camera_mm = rig.T_camera_belt * point_belt_mm;
  target.normal_camera = rig.T_camera_belt.rotation * normal_belt;
  target.height_mm = height_mm;
  return target;
}

// Both balls in view with their whole outline.
bool balls_in_view(const Rig& rig, const Vec3& first, const Vec3& second, double radius_mm) {
  for (const Vec3& centre : {first, second}) {
    for (int i = 0; i < 12; ++i) {
      const double angle = 2.0 * kPi * i / 12;
      if (!in_view(rig, centre + radius_mm * Vec3(std::cos(angle), std::sin(angle), 0.0))) return false;
    }
  }
  return true;
}

Result<TargetScene> place_ball_bar(const Rig& rig, const BallBarOptions& o, Random& random) {
  for (int tried = 0; tried < kTries; ++tried) {
    const double turn = random.uniform(0.0, 2.0 * kPi);
    const double low = random.uniform(o.radius_mm, kHighestMm - o.radius_mm);
    const double high = random.uniform(o.radius_mm, kHighestMm - o.radius_mm);
    if (std::abs(high - low) > o.distance_mm) continue;
    const double level = std::sqrt(o.distance_mm * o.distance_mm - (high - low) * (high - low));
    Vec3 first = random_place(rig, random);
    first.z() = low;
    const Vec3 second = first + Vec3(level * std::cos(turn), level * std::sin(turn), high - low);
    if (!balls_in_view(rig, first, second, o.radius_mm)) continue;
    TargetScene scene;
    for (const Vec3& centre : {first, second}) {
      BeltPose pose;
      pose.translation_mm = centre;
      scene.instances.push_back({0, rig.T_camera_belt * pose});
      TrueTarget target;
      target.kind = TrueTarget::Kind::kSphere;
      target.instance = static_cast<int>(scene.instances.size());
      target.point_camera_mm = rig.T_camera_belt * centre;
      target.radius_mm = o.radius_mm;
      scene.targets.push_back(target);
    }
    return scene;
  }
  return failure(ResultCode::kValueOutOfRange,
                 "ball bar: expected one that fits the view, found balls of radius %g mm, %g mm apart", o.radius_mm,
                 o.distance_mm);
}

Result<TargetScene> place_wedge(const Rig& rig, const StepOptions& o, Random& random) {
  // Heights fall towards the projector.
  const Vec3 projector = rig.T_camera_belt.inverse() * rig.T_projector_camera.inverse().translation_mm;
  const double base_turn = std::atan2(projector.y(), projector.x());
  for (int tried = 0; tried < kTries; ++tried) {
    const double turn = base_turn + random.uniform(-0.25, 0.25);
    BeltPose T_belt_wedge{Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix(), random_place(rig, random)};
    TargetScene scene;
    bool seen = true;
    for (int i = 0; i < o.steps && seen; ++i) {
      const double along = (i - 0.5 * (o.steps - 1)) * o.width_mm;
      const int rung = o.steps - 1 - i;
      const double top = o.base_mm + rung * o.rise_mm;
      BeltPose T_wedge_step;
      T_wedge_step.translation_mm = {along, 0.0, 0.0};
      for (const double side_x : {-0.5, 0.5}) {
        for (const double side_y : {-0.5, 0.5}) {
          seen = seen && in_view(rig, T_belt_wedge * Vec3(along + side_x * o.width_mm, side_y * o.depth_mm, top));
        }
      }
      const Vec3 middle = T_belt_wedge * T_wedge_step.translation_mm;
      scene.instances.push_back({rung, rig.T_camera_belt * BeltPose{T_belt_wedge.rotation, middle}});
      scene.targets.push_back(plane_target(rig, i + 1, middle + top * Vec3::UnitZ(), Vec3::UnitZ(), rung * o.rise_mm));
    }
    if (seen) return scene;
  }
  return failure(ResultCode::kValueOutOfRange, "wedge: expected one that fits the view, found %d steps of %g x %g mm",
                 o.steps, o.width_mm, o.depth_mm);
}

// How far from the middle of the belt the view reaches.
double view_radius_mm(const Rig& rig) {
  double radius = 0.0;
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) radius = std::max(radius, on_belt(rig, x, y).head<2>().norm());
  }
  return radius;
}

PlanePlace spread_place(const Rig& rig, int k, double phase, Random& random) {
  constexpr double kSteepestDeg = 11.0;
  if (k == 0) return {};
  if (k == 1) return {kHighestMm, 0.0, 0.0};
  if (k == 2) return {0.5 * kHighestMm, 0.0, 0.0};
  PlanePlace place;
  place.towards_deg = 360.0 * (phase + 0.381966 * k);
  place.tilt_deg = random.uniform(0.4, 1.0) * kSteepestDeg;
  const double rise = view_radius_mm(rig) * std::tan(rad_from_deg(place.tilt_deg));
  const double reach = std::min(rise, 0.5 * kHighestMm);
  place.height_mm = random.uniform(reach, kHighestMm - reach);
  return place;
}

TargetScene place_plane(const Rig& rig, const PlanePlace& place) {
  const double height_mm = std::max(place.height_mm, kPlaneThicknessMm);
  const double towards = rad_from_deg(place.towards_deg);
  const Vec3 axis(-std::sin(towards), std::cos(towards), 0.0);
  BeltPose pose;
  pose.rotation = Eigen::AngleAxisd(rad_from_deg(place.tilt_deg), axis).toRotationMatrix();
  const Vec3 normal = pose.rotation.col(2);
  const Vec3 point = on_belt(rig, 0.5, 0.5, height_mm);
  pose.translation_mm = point - kPlaneThicknessMm * normal;
  TargetScene scene;
  scene.instances.push_back({0, rig.T_camera_belt * pose});
  scene.targets.push_back(plane_target(rig, 1, point, normal, height_mm));
  return scene;
}

}  // namespace

Result<TargetStage> make_ball_bars(const Rig& rig, const BallBarOptions& options, int count, std::uint64_t seed) {
  if (!(options.radius_mm >= 5.0 && options.radius_mm < 0.5 * kHighestMm &&
        options.distance_mm > 2.0 * options.radius_mm && options.distance_mm < 2000.0)) {
    return failure(ResultCode::kValueOutOfRange,
                   "ball bar: expected radius 5..50 mm and centres farther apart than two radii, found %g and %g mm",
                   options.radius_mm, options.distance_mm);
  }
  auto ball = make_ball("ball", options.radius_mm);
  if (!ball) return std::unexpected(ball.error());
  TargetStage stage;
  stage.parts.push_back(std::move(*ball));
  Random random(seed, 41);
  for (int k = 0; k < count; ++k) {
    auto scene = place_ball_bar(rig, options, random);
    if (!scene) return std::unexpected(scene.error());
    stage.scenes.push_back(std::move(*scene));
  }
  return stage;
}

Result<TargetStage> make_step_wedges(const Rig& rig, const StepOptions& options, int count, std::uint64_t seed) {
  const double highest = options.base_mm + (options.steps - 1) * options.rise_mm;
  if (options.steps < 2 || options.steps > 30 || !(options.rise_mm > 0.0) || highest > kPartHeightMm) {
    return failure(ResultCode::kValueOutOfRange,
                   "wedge: expected 2..30 steps up to %g mm in all, found %d steps of %g mm", kPartHeightMm,
                   options.steps, options.rise_mm);
  }
  TargetStage stage;
  for (int i = 0; i < options.steps; ++i) {
    const double top = options.base_mm + i * options.rise_mm;
    auto block = make_block("step_" + std::to_string(i), {options.width_mm, options.depth_mm, top});
    if (!block) return std::unexpected(block.error());
    stage.parts.push_back(std::move(*block));
  }
  Random random(seed, 43);
  for (int k = 0; k < count; ++k) {
    auto scene = place_wedge(rig, options, random);
    if (!scene) return std::unexpected(scene.error());
    stage.scenes.push_back(std::move(*scene));
  }
  return stage;
}

Result<TargetStage> make_planes(const Rig& rig, const std::optional<PlanePlace>& place, int count, std::uint64_t seed) {
  const double side_mm = std::min(3.2 * view_radius_mm(rig), 1400.0);
  auto slab = make_block("plane", {side_mm, side_mm, kPlaneThicknessMm});
  if (!slab) return std::unexpected(slab.error());
  TargetStage stage;
  stage.parts.push_back(std::move(*slab));
  Random random(seed, 47);
  const double phase = random.uniform();
  for (int k = 0; k < count; ++k) {
    stage.scenes.push_back(place_plane(rig, place.value_or(spread_place(rig, k, phase, random))));
  }
  return stage;
}

}  // namespace beltpick::virtual_cell
