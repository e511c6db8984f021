// In which order parts are offered, and with which grasp, where they lie side by side.
#include <catch2/catch.hpp>
#include <cstring>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/locate.hpp"
#include "pipeline/pick_order.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

LocatedPart part(double top_mm, double score = 0.9, int grasp = 0) {
  LocatedPart made;
  made.top_mm = top_mm;
  made.score = score;
  made.grasp_index = grasp;
  return made;
}

std::vector<std::size_t> order_of(const std::vector<LocatedPart>& parts) {
  std::vector<std::size_t> order(parts.size());
  pipeline::order_picks(parts, order);
  return order;
}

using Order = std::vector<std::size_t>;

}  // namespace

TEST_CASE("the top-most part that can be gripped comes first", "[order]") {
  CHECK(order_of({part(20), part(60), part(40)}) == Order{1, 2, 0});
  CHECK(order_of({part(20), part(60, 0.9, -1), part(40)}) == Order{2, 0, 1});
  CHECK(order_of({}) == Order{});
}

TEST_CASE("side by side the better verified one comes first, one that stands alone before one that touches",
          "[order]") {
  CHECK(order_of({part(31, 0.8), part(30, 0.95), part(32, 0.9)}) == Order{1, 2, 0});
  auto touching = part(32, 0.99);
  touching.touches_neighbour = true;
  CHECK(order_of({touching, part(30, 0.7)}) == Order{1, 0});
  auto under = part(32, 0.99);
  under.hidden_share = 0.3;
  CHECK(order_of({under, touching}) == Order{1, 0});
}

TEST_CASE("layers are counted from what is left: the order does not depend on how parts are numbered", "[order]") {
  // Each within a layer of the next, the last not of the first.
  const std::vector<LocatedPart> stairs{part(40, 0.7), part(32, 0.9), part(24, 0.99)};
  CHECK(order_of(stairs) == Order{1, 0, 2});
  CHECK(order_of({stairs[2], stairs[0], stairs[1]}) == Order{2, 1, 0});
}

TEST_CASE("of parts wall to wall each is offered by the grasp that clears the other, or not at all", "[order]") {
  const Shape shape = bracket();  // its wall: 10 x 60 mm, at x = -45
  PartTemplate taught = template_of(shape);
  Grasp across{"across the wall", {}, 18.0};
  across.T_part_gripper.rotation << Vec3::UnitX(), (-Vec3::UnitZ()).cross(Vec3::UnitX()), -Vec3::UnitZ();
  across.T_part_gripper.translation_mm = {-45.0, 0.0, 45.0};
  Grasp along = across;
  along.name = "along the wall";
  along.opening_mm = 68.0;
  along.T_part_gripper.rotation << Vec3::UnitY(), (-Vec3::UnitZ()).cross(Vec3::UnitY()), -Vec3::UnitZ();
  const bool both = GENERATE(true, false);
  taught.grasps = both ? std::vector{across, along} : std::vector{across};

  InArena<pipeline::ModelStore> store(test_limits());
  REQUIRE(store.made.load({&taught, 1}));
  InArena<pipeline::Locator> locator(test_limits(), 1);
  const Mat3 about = Eigen::AngleAxisd(kPi, Vec3::UnitZ()).toRotationMatrix();
  // Walls towards each other, 6 mm between them.
  SceneImage image = render({{&shape, on_belt(shape, taught, Mat3::Identity(), 53.0, 0.0)},
                             {&shape, on_belt(shape, taught, about, -53.0, 0.0)}},
                            {.shadows = false});
  const auto found = locator.made.locate(input_of(image), store.made.models());
  REQUIRE(found.parts.size() == 2);
  for (const LocatedPart& located : found.parts) {
    CHECK(located.grasp_index == (both ? 1 : -1));
    CHECK((located.not_offered.code == ResultCode::kOk) == both);
    if (!both) {
      CHECK(located.not_offered.code == ResultCode::kObstructed);
      CHECK(std::strlen(located.not_offered.detail) > 20);
    }
  }
}
