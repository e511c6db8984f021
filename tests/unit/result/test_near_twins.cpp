// Parts that differ in one hole: told apart by that hole alone, however small its share of the surface.
#include <array>
#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "result/verdict.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

Distance bore(double x_mm, double y_mm, double length_mm) {
  return [=](const Vec3& p) {
    return std::max(std::hypot(p.x() - x_mm, p.y() - y_mm) - 9.5, std::abs(p.z() - 5.0) - 0.5 * length_mm);
  };
}

Shape undrilled() {
  Shape shape = bracket();
  const Distance small_hole = shape.distance, plug = bore(25.0, -18.0, 10.0);
  shape.name = "undrilled bracket";
  shape.distance = [=](const Vec3& p) { return std::min(small_hole(p), plug(p)); };
  return shape;
}

Shape drilled_at(double x_mm, double y_mm) {
  Shape shape = undrilled();
  const Distance solid = shape.distance, hole = bore(x_mm, y_mm, 30.0);
  shape.name = "drilled bracket";
  shape.distance = [=](const Vec3& p) { return std::max(solid(p), -hole(p)); };
  return shape;
}

// A part taught, and judged where an object lies on the belt, lit from the side.
struct Judge {
  LoadedPart loaded;
  InArena<result::Drawing> drawing{test_limits()};
  InArena<result::BlemishFinder> blemishes{test_limits()};
  InArena<result::ShadowMap> shadows{test_limits()};

  explicit Judge(const Shape& taught) : loaded(taught) {}

  Result<void> verdict(const Shape& lying, double turn_rad) {
    const PartModel& model = loaded.model();
    const Mat3 turn = Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()).toRotationMatrix();
    const result::PartPose pose = on_belt(lying, loaded.part, turn, 10.0, -15.0);
    SceneImage image = render({{&lying, pose}});
    shadows.made.cast(image.range(), scene_light_mm(), image.belt);
    const result::Scene scene{image.range(), image.labels(), image.lens, image.belt, scene_light_mm(), &shadows.made};
    drawing.made.draw(model.fine, pose, image.lens);
    static constexpr std::array<std::uint16_t, 1> kLabel{1};
    auto evidence = result::weigh(drawing.made, model, pose, scene, {image.labels(), kLabel});
    evidence.blemishes = blemishes.made.find(drawing.made, scene, model.spacing_mm);
    return result::judge(evidence, result::surface_tolerance_mm(scene, model.spacing_mm), {});
  }
};

std::string reason(const Result<void>& verdict) { return verdict ? "" : verdict.error().detail; }

}  // namespace

TEST_CASE("a hole that is not the part's, or is missing, or elsewhere, gives a similar part away") {
  const Shape right = drilled_at(25.0, -18.0);
  Judge drilled(right), solid(undrilled());
  for (const double turn_rad : {0.0, 2.5}) {
    INFO(turn_rad);
    const auto seen_through = solid.verdict(right, turn_rad);
    REQUIRE_FALSE(seen_through);
    CHECK(seen_through.error().code == ResultCode::kFreeSpaceViolated);
    const auto filled = drilled.verdict(undrilled(), turn_rad);
    REQUIRE_FALSE(filled);
    CHECK(filled.error().code == ResultCode::kResidualTooHigh);
    CHECK_FALSE(drilled.verdict(drilled_at(-5.0, -12.0), turn_rad));
    CHECK(reason(drilled.verdict(right, turn_rad)) == "");
    CHECK(reason(solid.verdict(undrilled(), turn_rad)) == "");
  }
}

TEST_CASE("thin parts and parts with many holes are believed where they lie") {
  for (const Shape& shape : {sheet(), flange()}) {
    Judge judge(shape);
    for (const double turn_rad : {0.0, 1.2, 2.5}) {
      INFO(shape.name << " " << turn_rad);
      CHECK(reason(judge.verdict(shape, turn_rad)) == "");
    }
  }
}
