// The light of a foreign cloud, found by its shadows.
#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "pipeline/light_fit.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

SceneImage two_parts(const SceneOptions& options) {
  static const Shape one = bracket(), other = knuckle();
  static const LoadedPart first(one), second(other);
  return render({{&one, on_belt(one, first.part, Mat3::Identity(), -60.0, 10.0)},
                 {&other, on_belt(other, second.part, any_rotation(2), 70.0, -10.0)}},
                options);
}

using Finder = InArena<pipeline::LightFinder>;

}  // namespace

TEST_CASE("shadows point to the light") {
  Finder finder(test_limits());
  for (const double gap_share : {0.0, 0.05}) {
    SceneImage image = two_parts({.gap_share = gap_share});
    const auto light = finder.made.find(image.range(), image.lens, image.belt);
    REQUIRE(light);
    const Vec3 middle(0.0, 0.0, 700.0);
    const Vec3 to_truth = (scene_light_mm() - middle).normalized();
    CHECK(deg_from_rad(std::acos(to_truth.dot((*light - middle).normalized()))) < 8.0);
  }
}

TEST_CASE("where nothing casts a shadow no light is told") {
  Finder finder(test_limits());
  SceneImage image = two_parts({.gap_share = 0.02, .shadows = false});
  CHECK_FALSE(finder.made.find(image.range(), image.lens, image.belt));
  CHECK_FALSE(finder.made.find(image.range(), image.lens, std::nullopt));
}

TEST_CASE("gaps that are no shadows tell no light") {
  Finder finder(test_limits());
  SceneImage image = two_parts({.shadows = false});
  // Squares of nothing all over the belt, as of oil spots.
  for (int row = 20; row < image.lens.height; row += 60) {
    for (int col = 20; col < image.lens.width; col += 60) {
      for (int r = row; r < std::min(row + 24, image.lens.height); ++r) {
        for (int c = col; c < std::min(col + 24, image.lens.width); ++c) {
          image.point_mm[static_cast<std::size_t>(r * image.lens.width + c)] = Vec3f::Zero();
        }
      }
    }
  }
  CHECK_FALSE(finder.made.find(image.range(), image.lens, image.belt));
}
