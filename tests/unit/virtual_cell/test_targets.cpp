// Balls, wedges and planes of known shape, against the true points of the pixels that see them.
#include <catch2/catch.hpp>
#include <cmath>

#include "virtual_cell/render/target_shapes.hpp"
#include "virtual_cell/render/trueness_targets.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

Rig small_rig() {
  RigOptions options;
  options.camera_width = 640;
  options.camera_height = 480;
  return make_rig(options).value();
}

// Calls `look` with every target and the true points of its instance, camera frame.
template <class Look>
void for_each_target(const Rig& rig, const TargetStage& stage, Look look) {
  SceneRenderer renderer(rig, stage.parts);
  for (const TargetScene& scene : stage.scenes) {
    renderer.place(scene.instances, 1);
    for (const TrueTarget& target : scene.targets) {
      std::vector<Vec3> points;
      for (int row = 0; row < rig.camera.height; ++row) {
        for (int col = 0; col < rig.camera.width; ++col) {
          if (renderer.true_instances()(row, col) != target.instance) continue;
          points.push_back(renderer.true_points_mm()(row, col).cast<double>());
        }
      }
      look(scene, target, points);
    }
  }
}

}  // namespace

TEST_CASE("a ball's facets keep to its radius") {
  const ScenePart ball = make_ball("ball", 20.0).value();
  double sum = 0.0;
  for (const auto& face : ball.mesh.face) {
    double worst = 0.0;
    for (const std::array<double, 3>& share : {std::array{1 / 3., 1 / 3., 1 / 3.}, std::array{1., 0., 0.},
                                               std::array{0.5, 0.5, 0.}, std::array{0.6, 0.2, 0.2}}) {
      Vec3 point = Vec3::Zero();
      for (int i = 0; i < 3; ++i) point += share[i] * ball.mesh.vertex_mm[face[i]].cast<double>();
      worst = std::max(worst, std::abs(point.norm() - 20.0));
      sum += (point.norm() - 20.0) / (4.0 * static_cast<double>(ball.mesh.face.size()));
    }
    REQUIRE(worst < 0.002);
  }
  CHECK(std::abs(sum) < 5e-4);
}

TEST_CASE("two balls stand where the truth says, wholly in view, their centres as far apart as asked") {
  const Rig rig = small_rig();
  const BallBarOptions options{18.0, 90.0};
  const TargetStage stage = make_ball_bars(rig, options, 3, 5).value();
  for (const TargetScene& scene : stage.scenes) {
    REQUIRE(scene.targets.size() == 2);
    const Vec3 between = scene.targets[0].point_camera_mm - scene.targets[1].point_camera_mm;
    CHECK(between.norm() == Approx(90.0));
    for (const TrueTarget& target : scene.targets) {
      const Vec3 on_belt = rig.T_camera_belt.inverse() * target.point_camera_mm;
      CHECK(on_belt.z() >= 18.0);
      CHECK(on_belt.z() <= 100.0 - 18.0);
    }
  }
  for_each_target(rig, stage, [&](const TargetScene&, const TrueTarget& target, const std::vector<Vec3>& points) {
    REQUIRE(points.size() > 1000);
    double worst = 0.0;
    for (const Vec3& point : points) worst = std::max(worst, std::abs((point - target.point_camera_mm).norm() - 18.0));
    CHECK(worst < 0.003);
  });
  CHECK(!make_ball_bars(rig, {18.0, 30.0}, 1, 1));
  CHECK(make_ball_bars(rig, {20.0, 900.0}, 1, 1).error().text().find("900") != std::string_view::npos);
}

TEST_CASE("a wedge's steps rise as they should, up to 100 mm, and none shades another") {
  const Rig rig = small_rig();
  const TargetStage stage = make_step_wedges(rig, {}, 2, 5).value();
  SceneRenderer renderer(rig, stage.parts);
  for (const TargetScene& scene : stage.scenes) {
    renderer.place(scene.instances, 1);
    REQUIRE(scene.targets.size() == 6);
    CHECK(scene.targets.front().height_mm == Approx(100.0));
    CHECK(scene.targets.back().height_mm == Approx(0.0));
    std::vector<int> tops(7, 0), lit(7, 0);
    for (int row = 0; row < rig.camera.height; ++row) {
      for (int col = 0; col < rig.camera.width; ++col) {
        const int instance = renderer.true_instances()(row, col);
        if (instance == 0) continue;
        const double z = (rig.T_camera_belt.inverse() * renderer.true_points_mm()(row, col).cast<double>()).z();
        // 4 mm of base under all steps; what is lower is a side.
        if (std::abs(z - 4.0 - scene.targets[instance - 1].height_mm) > 0.005) continue;
        ++tops[instance];
        lit[instance] += renderer.lit(row, col) ? 1 : 0;
      }
    }
    for (int i = 1; i <= 6; ++i) {
      CHECK(tops[i] > 5000);
      CHECK(lit[i] > 0.97 * tops[i]);
    }
  }
  CHECK(!make_step_wedges(rig, {.steps = 9}, 1, 1));
}

TEST_CASE("planes fill the view at the heights and tilts of the truth") {
  const Rig rig = small_rig();
  const Vec3 up = rig.T_camera_belt.rotation.col(2);
  const auto look = [&](const TargetScene&, const TrueTarget& target, const std::vector<Vec3>& points) {
    CHECK(points.size() == static_cast<std::size_t>(640 * 480));
    double worst = 0.0;
    for (const Vec3& point : points) {
      worst = std::max(worst, std::abs(target.normal_camera.dot(point - target.point_camera_mm)));
    }
    CHECK(worst < 0.002);
  };
  const TargetStage spread = make_planes(rig, {}, 5, 3).value();
  for_each_target(rig, spread, look);
  const TargetStage one = make_planes(rig, PlanePlace{60.0, 8.0, 90.0}, 1, 3).value();
  for_each_target(rig, one, look);
  const TrueTarget& target = one.scenes[0].targets[0];
  CHECK(std::acos(target.normal_camera.dot(up)) == Approx(8.0 * 3.14159265 / 180.0));
  CHECK((rig.T_camera_belt.inverse() * target.point_camera_mm).z() == Approx(60.0));
  CHECK((rig.T_camera_belt.rotation.transpose() * target.normal_camera).y() > 0.1);
}
