#include <catch2/catch.hpp>

#include <vector>

#include "contract/result_codes.hpp"
#include "cycle/pick_plan.hpp"

using namespace beltpick;
using namespace beltpick::cycle;

namespace {
std::vector<LocatedPart> parts(std::initializer_list<std::pair<int, bool>> grasp_and_touch) {
  std::vector<LocatedPart> made;
  for (const auto& [grasp, touches] : grasp_and_touch) {
    LocatedPart part;
    part.grasp_index = grasp;
    part.touches_neighbour = touches;
    made.push_back(part);
  }
  return made;
}
}  // namespace

TEST_CASE("parts without a grasp are never offered but counted", "[plan]") {
  PickPlan plan;
  const auto view = parts({{-1, false}, {0, false}, {-1, true}});
  plan.load(view, 2);
  CHECK(plan.next() == 1);
  CHECK(plan.parts_left() == 1);
  CHECK(plan.not_pickable() == 4);
}

TEST_CASE("a pick that touched nothing voids what touched something, whoever that was", "[plan]") {
  PickPlan plan;
  const auto view = parts({{0, false}, {0, true}, {0, false}});
  plan.load(view, 0);
  plan.picked(0);
  CHECK(plan.parts_left() == 1);
  CHECK(plan.next() == 2);
  CHECK(plan.capture_again());
}

TEST_CASE("a pick that touched something voids the whole view", "[plan]") {
  PickPlan plan;
  const auto view = parts({{0, true}, {0, false}, {0, true}});
  plan.load(view, 0);
  plan.picked(0);
  CHECK(plan.next() == -1);
  CHECK(plan.capture_again());
}

TEST_CASE("parts that all stand alone need no other look", "[plan]") {
  PickPlan plan;
  const auto view = parts({{0, false}, {0, false}});
  plan.load(view, 0);
  plan.picked(0);
  plan.picked(1);
  CHECK_FALSE(plan.capture_again());
}

TEST_CASE("a view of which nothing was picked is not captured again", "[plan]") {
  PickPlan plan;
  const auto view = parts({{0, true}, {0, true}});
  plan.load(view, 3);
  plan.skipped(0);
  plan.skipped(1);
  CHECK(plan.next() == -1);
  CHECK_FALSE(plan.capture_again());
}

TEST_CASE("more parts than the plan holds count as withheld", "[plan]") {
  PickPlan plan;
  const std::vector<LocatedPart> view(PickPlan::kMaxParts + 5, parts({{0, false}}).front());
  plan.load(view, 1);
  CHECK(plan.parts_left() == PickPlan::kMaxParts);
  CHECK(plan.not_pickable() == 6);
}

TEST_CASE("why the first part without a grasp has none is passed on", "[plan]") {
  PickPlan plan;
  auto view = parts({{0, false}, {-1, false}, {-1, false}});
  view[1].not_offered = failure(ResultCode::kObstructed, "a neighbour").error();
  plan.load(view, 0);
  CHECK(plan.without_grasp_code() == ResultCode::kObstructed);
  plan.load(parts({{0, false}}), 0);
  CHECK(plan.without_grasp_code() == ResultCode::kOk);
}
