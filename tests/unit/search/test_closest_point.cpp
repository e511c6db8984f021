// The closest-point grid and tree against going through all points.
#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "base/random.hpp"
#include "contract/find_nearest.hpp"
#include "support/scenes/models.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

float nearest_by_all(const PartModel& model, const Vec3f& at) {
  float best = std::numeric_limits<float>::max();
  for (const OrientedPoint& point : model.surface) best = std::min(best, (point.point_mm - at).norm());
  return best;
}

Vec3f anywhere(Random& random, const PartModel& model, double margin_mm) {
  const Vec3 low = model.box_min_mm - Vec3::Constant(margin_mm);
  const Vec3 size = model.box_max_mm - model.box_min_mm + Vec3::Constant(2.0 * margin_mm);
  return (low + size.cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()))).cast<float>();
}

}  // namespace

TEST_CASE("the grid's nearest point is nearest up to a cell's diagonal") {
  const LoadedPart loaded(bracket());
  const PartModel& model = loaded.model();
  const float diagonal_mm = 1.7321F * model.grid.shape().cell_mm;
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3f at = anywhere(random, model, 5.0);
    const float found = (model.surface[model.grid.nearest(at)].point_mm - at).norm();
    CHECK(found <= nearest_by_all(model, at) + diagonal_mm);
  }
}

TEST_CASE("the grid answers outside its box too") {
  const LoadedPart loaded(bracket());
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vec3f at = anywhere(random, loaded.model(), 200.0);
    CHECK(loaded.model().grid.nearest(at) < loaded.model().surface.size());
  }
}

TEST_CASE("the tree's nearest point is the nearest") {
  const LoadedPart loaded(bracket());
  const PartModel& model = loaded.model();
  const ClosestPointTree tree(model.surface);
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Vec3f at = anywhere(random, model, 30.0);
    CHECK((model.surface[tree.nearest(at)].point_mm - at).norm() == Approx(nearest_by_all(model, at)).margin(1e-4));
  }
}

TEST_CASE("a planned grid stays within its cells and covers the box") {
  const GridShape shape = plan_closest_point_grid({-50, -30, 0}, {50, 30, 55}, 6.0, 0.2, 200'000);
  CHECK(shape.count() <= 200'000);
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = shape.origin_mm[axis] + shape.cell_mm * static_cast<float>(shape.cells[axis]);
    CHECK(reach >= Vec3(50, 30, 55)[axis] + 6.0 - 1e-3);
  }
}

TEST_CASE("a store without grid cells looks up in the tree, and finds what the grid finds") {
  Limits limits = test_limits();
  limits.grid_cells = 0;
  const LoadedPart by_tree(bracket(), limits);
  const LoadedPart by_grid(bracket());
  REQUIRE(by_tree.model().tree != nullptr);
  REQUIRE(by_grid.model().tree == nullptr);
  const float diagonal_mm = 1.7321F * by_grid.model().grid.shape().cell_mm;
  Random random(6);
  for (int i = 0; i < 500; ++i) {
    const Vec3f at = anywhere(random, by_tree.model(), 5.0);
    const float exact_mm = (by_tree.model().nearest(at).point_mm - at).norm();
    const float grid_mm = (by_grid.model().nearest(at).point_mm - at).norm();
    CHECK(exact_mm == Approx(nearest_by_all(by_tree.model(), at)).margin(1e-4));
    CHECK(grid_mm <= exact_mm + diagonal_mm);
  }
}

TEST_CASE("many places at once are looked up as one at a time, with either index") {
  Limits limits = test_limits();
  for (const int cells : {limits.grid_cells, 0}) {
    limits.grid_cells = cells;
    const LoadedPart loaded(bracket(), limits);
    Random random(7);
    PointBlock at, nearest;
    const int count = 41;
    for (int i = 0; i < count; ++i) at.put({anywhere(random, loaded.model(), 40.0), Vec3f::UnitZ()}, i);
    at.fill_up(count);
    find_nearest(loaded.model(), at, count, nearest);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const OrientedPoint& one = loaded.model().nearest({at.x[i], at.y[i], at.z[i]});
      CHECK(Vec3f(nearest.x[i], nearest.y[i], nearest.z[i]) == one.point_mm);
      CHECK(Vec3f(nearest.nx[i], nearest.ny[i], nearest.nz[i]) == one.normal);
    }
  }
}
