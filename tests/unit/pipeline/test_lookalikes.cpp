// Mirror images of a part that fit what was measured of it as well as the part does.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <vector>

#include "base/units.hpp"
#include "pipeline/lookalikes.hpp"
#include "support/scenes/models.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

Primitive face(const Vec3& point_mm, const Vec3& outward) {
  Primitive plane;
  plane.point_mm = point_mm;
  plane.direction = outward;
  return plane;
}

// Of the outside of the bracket's L only what lies within reach of its edge.
std::vector<OrientedPoint> corner(float reach_mm) {
  std::vector<OrientedPoint> points;
  for (float along = -25.0F; along <= 25.0F; along += 5.0F) {
    for (float away = 2.0F; away < reach_mm; away += 5.0F) {
      points.push_back({Vec3f(-50.0F + away, along, 0.0F), Vec3f(0.0F, 0.0F, -1.0F)});
      points.push_back({Vec3f(-50.0F, along, away), Vec3f(-1.0F, 0.0F, 0.0F)});
    }
  }
  return points;
}

// Whether among the mirror images offered there is one that takes the long leg for the short one.
bool legs_exchanged(const PartModel& model, const std::vector<OrientedPoint>& points) {
  std::array<Hypothesis, 200> storage;
  search::HypothesisPool pool(storage);
  pipeline::offer_mirrored(model, {}, search::SearchSample(points), pool);
  std::array<Hypothesis, 16> found;
  const std::size_t count = pool.take_distinct(model, 4.0, rad_from_deg(12.0), found);
  return std::any_of(found.begin(), found.begin() + count, [](const Hypothesis& h) {
    return h.mean_distance_mm < 1.5F && h.T_camera_part.rotation(0, 2) > 0.99 &&
           h.T_camera_part.rotation.determinant() < 0.0;
  });
}

}  // namespace

TEST_CASE("of an angle whose longer leg is hidden beyond the other's length, either leg may be the longer one",
          "[lookalikes]") {
  Shape shape = bracket();
  shape.primitives = {face({0.0, 0.0, 0.0}, -Vec3::UnitZ()), face({-50.0, 0.0, 30.0}, -Vec3::UnitX())};
  const LoadedPart loaded(shape);
  CHECK(legs_exchanged(loaded.model(), corner(50.0F)));
  CHECK_FALSE(legs_exchanged(loaded.model(), corner(95.0F)));
}
