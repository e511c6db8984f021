// The way in of the virtual gripper against triangles and the belt.
#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "virtual_cell/world/gripper_path.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {
Mesh triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  Mesh mesh;
  mesh.vertex_mm = {a, b, c};
  mesh.face = {{0, 1, 2}};
  return mesh;
}

// Whether any of many points of the triangle lies in the box: never finds more than there is.
bool sampled(const JawSweep& box, const Mesh& mesh) {
  constexpr int kSteps = 60;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps - i; ++j) {
      const float u = static_cast<float>(i) / kSteps;
      const float v = static_cast<float>(j) / kSteps;
      const Vec3f at = mesh.vertex_mm[0] * (1 - u - v) + mesh.vertex_mm[1] * u + mesh.vertex_mm[2] * v;
      if (box.contains(at.cast<double>())) return true;
    }
  }
  return false;
}
}  // namespace

TEST_CASE("jaws stand outside the opening and reach back from the tips") {
  const JawSweep jaw = jaw_sweep({}, 40.0, -1);
  CHECK(jaw.min().x() == Approx(-28.0));
  CHECK(jaw.max().x() == Approx(-20.0));
  CHECK(jaw.max().z() == Approx(3.0));
}

TEST_CASE("a triangle meets the sweep where a sample of it says so, and only near there") {
  const JawSweep box = jaw_sweep({8, 16, 3, 60}, 40.0, 1);
  Random random(5);
  const auto point = [&] {
    return Vec3f(Vec3(random.uniform(0, 50), random.uniform(-30, 30), random.uniform(-80, 20)).cast<float>());
  };
  JawSweep swollen = box;
  swollen.min().array() -= 3.0;
  swollen.max().array() += 3.0;
  int meets = 0;
  for (int i = 0; i < 400; ++i) {
    const Mesh mesh = triangle(point(), point(), point());
    const bool found = sweep_meets_mesh(box, mesh, {});
    if (sampled(box, mesh)) CHECK(found);
    if (found) CHECK(sampled(swollen, mesh));
    meets += found;
  }
  CHECK(meets > 50);
  CHECK(meets < 350);
}

TEST_CASE("tips below the belt meet it") {
  Pose<frame::Belt, frame::Gripper> T_belt_gripper;
  T_belt_gripper.rotation = Eigen::AngleAxisd(3.14159265, Vec3::UnitX()).toRotationMatrix();
  const JawSweep jaw = jaw_sweep({}, 40.0, 1);
  T_belt_gripper.translation_mm.z() = 3.5;
  CHECK_FALSE(sweep_meets_belt(jaw, T_belt_gripper));
  T_belt_gripper.translation_mm.z() = 2.5;
  CHECK(sweep_meets_belt(jaw, T_belt_gripper));
}
