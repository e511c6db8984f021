// Cast shadows: known where the light went, and no evidence against a part that lies in one.
#include <algorithm>
#include <catch2/catch.hpp>

#include "result/evidence.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

constexpr float kMargin_mm = 3.0F;

// A bracket with a knuckle on its edge between it and the light.
struct Shaded {
  Shape shaded = bracket(), before = knuckle();
  LoadedPart loaded{shaded}, other{before};
  result::PartPose truth = on_belt(shaded, loaded.part, Mat3::Identity(), 30.0, 0.0);
  std::vector<Placed> parts{
      {&shaded, truth},
      {&before, on_belt(before, other.part, Eigen::AngleAxisd(1.5, Vec3::UnitX()).toRotationMatrix(), -40.0, 0.0)}};
  SceneImage lit = render(parts, {.gap_share = 0.0, .shadows = false});
  SceneImage image = render(parts, {.gap_share = 0.0});
  InArena<result::ShadowMap> shadows{test_limits()};
};

Vec3f towards_camera(const Vec3f& point_mm) { return -point_mm.normalized(); }

}  // namespace

TEST_CASE("what the light did not reach is hidden from it, and what was measured is not") {
  Shaded scene;
  scene.shadows.made.cast(scene.image.range(), scene_light_mm(), scene.image.belt);
  int dark = 0, told = 0, measured = 0, mistaken = 0;
  for (std::size_t i = 0; i < scene.image.point_mm.size(); ++i) {
    const Vec3f at = scene.lit.point_mm[i];
    if (at.z() <= 0.0F) continue;
    const bool hidden = scene.shadows.made.hides(at, towards_camera(at), kMargin_mm);
    if (scene.image.point_mm[i].z() > 0.0F) {
      ++measured;
      mistaken += hidden ? 1 : 0;
    } else {
      ++dark;
      told += hidden ? 1 : 0;
    }
  }
  CHECK(dark > 5000);
  CHECK(told > 0.8 * dark);  // the rest lies behind what was not measured itself, or close to its edge
  CHECK(mistaken < 0.01 * measured);
}

TEST_CASE("a part in a shadow is judged by what the light reached") {
  Shaded scene;
  InArena<result::Drawing> drawing(test_limits());
  drawing.made.draw(scene.loaded.model().fine, scene.truth, scene.image.lens);
  result::Scene seen{scene.image.range(), scene.image.labels(), scene.image.lens, scene.image.belt, scene_light_mm()};
  const auto ignorant = result::weigh(drawing.made, scene.loaded.model(), scene.truth, seen);
  scene.shadows.made.cast(scene.image.range(), scene_light_mm(), scene.image.belt);
  seen.shadows = &scene.shadows.made;
  const auto knowing = result::weigh(drawing.made, scene.loaded.model(), scene.truth, seen);
  CHECK(ignorant.coverage < 0.75);
  CHECK(knowing.coverage > 0.9);
  CHECK(knowing.support == ignorant.support);
  CHECK(knowing.shadowed > 0.2);
}

TEST_CASE("without a light, or without anything measured, nothing is in shadow") {
  Shaded scene;
  const Vec3f at = scene.lit.point_mm[scene.lit.point_mm.size() / 2];
  scene.shadows.made.cast(scene.image.range(), std::nullopt, scene.image.belt);
  CHECK_FALSE(scene.shadows.made.hides(at, towards_camera(at), kMargin_mm));
  std::fill(scene.image.point_mm.begin(), scene.image.point_mm.end(), Vec3f::Zero());
  scene.shadows.made.cast(scene.image.range(), scene_light_mm(), scene.image.belt);
  CHECK_FALSE(scene.shadows.made.hides(at, towards_camera(at), kMargin_mm));
}

TEST_CASE("a part that is known to lie there casts its shadow from all its sides") {
  Shaded scene;
  result::ShadowMap& shadows = scene.shadows.made;
  std::vector<Vec3f> hidden;
  for (std::size_t i = 0; i < scene.image.point_mm.size(); ++i) {
    if (scene.lit.point_mm[i].z() > 0.0F && scene.image.point_mm[i].z() <= 0.0F)
      hidden.push_back(scene.lit.point_mm[i]);
  }
  const auto told = [&] {
    const auto count = std::count_if(hidden.begin(), hidden.end(), [&](const Vec3f& at) {
      return shadows.hides(at, towards_camera(at), kMargin_mm);
    });
    return static_cast<double>(count);
  };
  const auto dark = static_cast<double>(hidden.size());
  shadows.cast(scene.image.range(), scene_light_mm(), std::nullopt);  // no belt: no sides are made up
  const auto seen = told();
  shadows.add(scene.other.model(), scene.parts[1].T_camera_part);
  shadows.add(scene.loaded.model(), scene.truth);
  const auto known = told();
  CHECK(seen < 0.9 * dark);
  CHECK(known > seen);
  CHECK(known > 0.9 * dark);
}

TEST_CASE("a part's own shadow, and places that are only just measured, are no evidence against its pose") {
  const Shape shape = bracket();
  const LoadedPart loaded(shape);
  const result::PartPose truth =
      on_belt(shape, loaded.part, Eigen::AngleAxisd(1.5, Vec3::UnitX()).toRotationMatrix(), 0.0, 0.0);
  InArena<result::Drawing> drawing(test_limits());
  for (const double gap_share : {0.0, 0.6}) {
    INFO(gap_share);
    SceneImage image = render({{&shape, truth}}, {.gap_share = gap_share});
    drawing.made.draw(loaded.model().fine, truth, image.lens);
    const auto evidence = result::weigh(drawing.made, loaded.model(), truth,
                                        {image.range(), image.labels(), image.lens, image.belt, scene_light_mm()});
    CHECK(evidence.gaps < 0.15);
  }
}
