// The ends of an object that are certain: those in its own shadow are, those of shadows that others cast on it are not.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "pipeline/outline_pairs.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;
using pipeline::Borders;

namespace {

constexpr double kReach_mm = 8.0, kStep_mm = 3.0;

// A block that casts a shadow on the belt; shaded, with a plate on edge between it and the light
// whose shadow falls on its rim.
struct Lit {
  Shape shape = block(), wall = plate();
  LoadedPart loaded{shape}, other{wall};
  result::PartPose truth = on_belt(shape, loaded.part, Mat3::Identity(), 30.0, 0.0);
  SceneImage image;
  InArena<result::ShadowMap> shadows{test_limits()};
  InArena<result::Drawing> drawing{test_limits()};
  std::array<icp::OutlinePair, 4096> pairs{};

  explicit Lit(bool shaded) {
    std::vector<Placed> parts{{&shape, truth}};
    Mat3 on_edge;
    on_edge << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    if (shaded) parts.push_back({&wall, on_belt(wall, other.part, on_edge, -76.0, 0.0)});
    image = render(parts, {.gap_share = 0.0});
    shadows.made.cast(image.range(), scene_light_mm(), image.belt);
  }

  // How far beyond the edges drawn of the block in a pose its ends lie, mm: of the edges that look along `side` in the
  // camera's image, of all where it is zero.
  std::vector<double> beyond_mm(const result::PartPose& pose, Borders borders, const Vec3& side,
                                bool light_known = true) {
    result::Scene scene{image.range(), image.labels(), image.lens, image.belt};
    if (light_known) scene.light_mm = scene_light_mm();
    if (light_known) scene.shadows = &shadows.made;
    drawing.made.draw(loaded.model().fine, pose, image.lens);
    const std::size_t count = pipeline::pair_outline(drawing.made, pose, scene, loaded.model().spacing_mm, kReach_mm,
                                                     kStep_mm, pairs, borders);
    std::vector<double> beyond;
    for (const icp::OutlinePair& pair : std::span(pairs).first(count)) {
      const Vec3 outward = pose.rotation * pair.outward.cast<double>();
      if (!side.isZero() && outward.dot(side) < 0.9) continue;
      beyond.push_back(outward.dot(pair.measured_mm.cast<double>() - pose * pair.on_part_mm.cast<double>()));
    }
    std::sort(beyond.begin(), beyond.end());
    return beyond;
  }
};

double share_off(const std::vector<double>& beyond_mm, double limit_mm) {
  const auto off = std::count_if(beyond_mm.begin(), beyond_mm.end(), [&](double b) { return std::abs(b) > limit_mm; });
  return static_cast<double>(off) / static_cast<double>(beyond_mm.size());
}

}  // namespace

TEST_CASE("an end in the object's own shadow is certain: light would have shown the object, did it go on",
          "[outline]") {
  Lit scene(false);
  result::PartPose slid = scene.truth;
  slid.translation_mm.x() += 2.0;
  const auto ends = scene.beyond_mm(slid, Borders::kCertain, Vec3::UnitX());
  REQUIRE(ends.size() > 10);
  CHECK(ends[ends.size() / 2] == Approx(-2.0).margin(0.8));
  // Of a light nobody told of, only what looks round the corner is known.
  CHECK(scene.beyond_mm(slid, Borders::kCertain, Vec3::UnitX(), false).size() < 5);
}

TEST_CASE("the ends of a shadow that something casts on the object are not certain", "[outline]") {
  Lit scene(true);
  const auto any = scene.beyond_mm(scene.truth, Borders::kAny, -Vec3::UnitX());
  const auto certain = scene.beyond_mm(scene.truth, Borders::kCertain, -Vec3::UnitX());
  REQUIRE(any.size() > 10);
  CHECK(share_off(any, 1.5) > 0.9);
  CHECK(certain.size() < 5);
}

TEST_CASE("where an object ends does not depend on where between two pixels its edge is drawn", "[outline]") {
  Lit scene(false);
  const auto middle_mm = [&](double shift_mm) {
    result::PartPose shifted = scene.truth;
    shifted.translation_mm.x() += shift_mm;
    const auto ends = scene.beyond_mm(shifted, Borders::kAny, Vec3::UnitX());
    REQUIRE(ends.size() > 10);
    return ends[ends.size() / 2] + shift_mm;
  };
  const double at_truth = middle_mm(0.0);
  CHECK(at_truth == Approx(0.0).margin(0.3));
  for (const double shift_mm : {-0.4, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.4})
    CHECK(middle_mm(shift_mm) == Approx(at_truth).margin(0.25));
}
