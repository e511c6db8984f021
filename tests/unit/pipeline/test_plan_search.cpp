// What a template tells the search, and what any template may not tell it.
#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "pipeline/plan_search.hpp"
#include "search/from_primitive.hpp"
#include "support/scenes/models.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

// The knuckle, loaded with what `change` makes of its template.
template <class Change>
PartModel loaded(InArena<pipeline::ModelStore>& store, Change change) {
  PartTemplate part = template_of(knuckle());
  change(part);
  REQUIRE(store.made.load({&part, 1}));
  return store.made.models().front();
}

}  // namespace

TEST_CASE("a template without routes and steps has every primitive looked for, in steps of 15 degrees") {
  InArena<pipeline::ModelStore> store(test_limits());
  const PartModel model = loaded(store, [](PartTemplate&) {});
  REQUIRE(model.looked_for().size() == model.taught().size());
  for (std::size_t i = 0; i < model.looked_for().size(); ++i) CHECK(model.looked_for()[i] == i);
  CHECK(search::turn_count(model) == 24);
  CHECK(model.shift_step_mm == Approx(0.035 * model.diagonal_mm));
}

TEST_CASE("only the primitives of the template's routes are looked for, in its order") {
  InArena<pipeline::ModelStore> store(test_limits());
  const PartModel model = loaded(store, [](PartTemplate& part) {
    REQUIRE(part.primitives.size() >= 2);
    part.routes = {{1, 0.9, 100}, {-1, 1.0, 3888}, {0, 0.2, 100}};
  });
  REQUIRE(model.looked_for().size() == 2);
  CHECK(model.looked_for()[0] == 1);
  CHECK(model.looked_for()[1] == 0);
  CHECK(model.taught().size() >= 2);
}

TEST_CASE("taught steps are taken within what the search can tell apart") {
  InArena<pipeline::ModelStore> store(test_limits());
  const auto with = [&](double turn_deg, double shift_share) {
    return loaded(store, [&](PartTemplate& part) {
      const double diagonal_mm = (part.box_max_mm - part.box_min_mm).norm();
      part.steps = {rad_from_deg(turn_deg), shift_share * diagonal_mm};
    });
  };
  const PartModel taught = with(12.0, 0.03);
  CHECK(search::turn_count(taught) == 30);
  CHECK(taught.shift_step_mm == Approx(0.03 * taught.diagonal_mm));
  const PartModel coarse = with(60.0, 0.4);
  CHECK(coarse.turn_step_rad <= rad_from_deg(18.0));
  CHECK(coarse.shift_step_mm <= 0.05 * coarse.diagonal_mm + 1e-9);
  const PartModel fine = with(0.5, 0.0001);
  CHECK(search::turn_count(fine) <= 36);
  CHECK(fine.shift_step_mm >= 0.02 * fine.diagonal_mm - 1e-9);
}

TEST_CASE("a template asks for more than any part must show, never for less") {
  InArena<pipeline::ModelStore> store(test_limits());
  const PartModel model = loaded(store, [](PartTemplate& part) {
    part.requirements = Requirements{.support = 0.4, .coverage = 0.1, .violated = 0.5, .residual = 0.2};
  });
  CHECK(model.required.support == 0.4);
  CHECK(model.required.residual == 0.2);
  CHECK(model.required.coverage == Requirements{}.coverage);
  CHECK(model.required.violated == Requirements{}.violated);
}
