// Exhaustive search: the true pose is within the basin of alignment of one of the best hypotheses.
#include <array>
#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "search/from_primitive.hpp"
#include "search/trials.hpp"
#include "search/views.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

// About 100 points of what a camera sees of the part, without going through an image.
std::vector<OrientedPoint> seen_sample(const PartModel& model, const search::PartPose& truth) {
  std::vector<OrientedPoint> sample;
  Random random(8);
  while (sample.size() < 100) {
    const OrientedPoint& point = model.surface[random.below(static_cast<std::uint32_t>(model.surface.size()))];
    const Vec3 at = truth * point.point_mm.cast<double>();
    const Vec3 normal = truth.rotation * point.normal.cast<double>();
    if (normal.dot(at) < 0.0) sample.push_back({at.cast<float>(), normal.cast<float>()});
  }
  return sample;
}

// Of the distinct best hypotheses the one nearest to the truth.
PoseDifference best_of(search::HypothesisPool& pool, const PartModel& model, const search::PartPose& truth) {
  std::array<Hypothesis, 40> best;
  const std::size_t count = pool.take_distinct(model, 0.04 * model.diagonal_mm, rad_from_deg(12.0), best);
  PoseDifference nearest{1e9, 1e9};
  for (std::size_t i = 0; i < count; ++i) {
    const PoseDifference d = difference_modulo_symmetry(best[i].T_camera_part, truth, model);
    if (d.translation_mm + 50.0 * d.rotation_rad < nearest.translation_mm + 50.0 * nearest.rotation_rad) nearest = d;
  }
  return nearest;
}

}  // namespace

TEST_CASE("with a matched cylinder the search comes near the true pose") {
  const LoadedPart loaded(knuckle());
  const PartModel& model = loaded.model();
  const search::PartPose truth{any_rotation(11), {15.0, -20.0, 690.0}};
  Primitive found = model.primitives[0];
  found.point_mm = truth * found.point_mm;
  found.direction = -(truth.rotation * found.direction);
  const auto sample = seen_sample(model, truth);
  std::vector<Hypothesis> storage(400);
  search::HypothesisPool pool(storage);
  const search::SearchInput input{model, search::SearchSample(sample), 12.0F};
  REQUIRE(search::search_from_primitive(input, model.primitives[0], found, pool) > 200);
  const PoseDifference d = best_of(pool, model, truth);
  CHECK(d.translation_mm < 4.0);
  CHECK(deg_from_rad(d.rotation_rad) < 8.0);
}

TEST_CASE("primitives of another kind, side or radius are not matched") {
  Primitive boss;
  boss.kind = PrimitiveKind::kCylinder;
  boss.radius_mm = 10.0;
  Primitive other = boss;
  CHECK(search::may_match(boss, other));
  other.radius_mm = 12.0;
  CHECK_FALSE(search::may_match(boss, other));
  other = boss;
  other.concave = true;
  CHECK_FALSE(search::may_match(boss, other));
  other = boss;
  other.kind = PrimitiveKind::kSphere;
  CHECK_FALSE(search::may_match(boss, other));
}

TEST_CASE("without a primitive the view search comes near the true pose") {
  for (const auto& shape : {bracket(), knuckle(), sheet()}) {
    const LoadedPart loaded(shape);
    const search::PartPose truth{any_rotation(21), {-10.0, 30.0, 700.0}};
    const auto sample = seen_sample(loaded.model(), truth);
    std::vector<Hypothesis> storage(400);
    search::HypothesisPool pool(storage);
    search::search_views(
        {loaded.model(), search::SearchSample(sample), static_cast<float>(0.08 * loaded.model().diagonal_mm)}, pool);
    const PoseDifference d = best_of(pool, loaded.model(), truth);
    INFO(shape.name);
    CHECK(d.translation_mm < 0.12 * loaded.model().diagonal_mm);
    CHECK(deg_from_rad(d.rotation_rad) < 22.0);
  }
}

TEST_CASE("the pool keeps the best, best first, and only what differs") {
  const LoadedPart loaded(bracket());
  std::vector<Hypothesis> storage(3);
  search::HypothesisPool pool(storage);
  for (const float q : {5.0F, 1.0F, 4.0F, 2.0F, 1.1F}) {
    Hypothesis h;
    h.mean_distance_mm = q;
    h.T_camera_part.translation_mm = Vec3(q > 1.5F ? 100.0 : 0.0, 0, 700);
    pool.offer(h);
  }
  std::array<Hypothesis, 3> best;
  REQUIRE(pool.take_distinct(loaded.model(), 5.0, 0.1, best) == 2);
  CHECK(best[0].mean_distance_mm == 1.0F);
  CHECK(best[1].mean_distance_mm == 2.0F);
}

TEST_CASE("trials put into the pool what one hypothesis after the other would") {
  const LoadedPart loaded(knuckle());
  const PartModel& model = loaded.model();
  const search::PartPose truth{any_rotation(5), {15.0, -20.0, 690.0}};
  const auto sample = seen_sample(model, truth);
  const search::SearchInput input{model, search::SearchSample(sample), 12.0F};
  std::vector<search::PartPose> poses;
  for (std::uint64_t seed = 1; seed <= 203; ++seed) {  // not a multiple of what is tried together
    Random random(seed);
    const Vec3 shift(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    poses.push_back({seed % 4 == 0 ? truth.rotation : any_rotation(seed), truth.translation_mm + shift});
  }
  std::vector<Hypothesis> plain_storage(20), storage(20);
  search::HypothesisPool plain(plain_storage), pool(storage);
  for (const search::PartPose& pose : poses) {
    const float distance = search::mean_distance_mm(input.sample, model, pose, input.cap_mm, plain.bar_mm());
    if (distance < plain.bar_mm()) plain.offer({pose, distance});
  }
  {
    search::Trials trials(input, pool);
    for (const search::PartPose& pose : poses) trials.add(pose);
  }
  REQUIRE(pool.size() == plain.size());
  REQUIRE(pool.size() == storage.size());
  for (std::size_t i = 0; i < storage.size(); ++i) {
    CHECK(storage[i].mean_distance_mm == plain_storage[i].mean_distance_mm);
    CHECK(storage[i].T_camera_part.translation_mm == plain_storage[i].T_camera_part.translation_mm);
  }
}

TEST_CASE("162 view directions are unit vectors and lie apart") {
  const auto& directions = search::view_directions();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    CHECK(directions[i].norm() == Approx(1.0));
    for (std::size_t j = i + 1; j < directions.size(); ++j) CHECK((directions[i] - directions[j]).norm() > 0.2);
  }
}
