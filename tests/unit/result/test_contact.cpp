#include <catch2/catch.hpp>
#include <memory>

#include "pipeline/model_store.hpp"
#include "result/contact.hpp"
#include "support/shapes.hpp"
#include "teach/teach.hpp"

using namespace beltpick;

namespace {

struct Box {
  PartTemplate part;
  std::unique_ptr<ArenaBlock> block;
  std::unique_ptr<Arena> arena;
  std::unique_ptr<pipeline::ModelStore> store;

  Box() : part(teach::teach(test::box(80, 40, 20), {}, {.points = 6000})->part) {
    Limits limits;
    limits.templates = 1;
    limits.template_points = 8000;
    limits.grid_cells = 500'000;
    Arena measuring;
    pipeline::ModelStore(measuring, limits);
    block = std::make_unique<ArenaBlock>(measuring.used_bytes());
    arena = std::make_unique<Arena>(block->data(), block->bytes());
    store = std::make_unique<pipeline::ModelStore>(*arena, limits);
    REQUIRE(store->load({&part, 1}).has_value());
  }
  [[nodiscard]] const PartModel& model() const { return store->models().front(); }
};

result::PartPose pose(const Vec3& translation_mm, double lean_rad) {
  return {Eigen::AngleAxisd(lean_rad, Vec3::UnitY()).toRotationMatrix(), translation_mm};
}

}  // namespace

TEST_CASE("a part that leans on another touches it, and the other touches it too", "[contact]") {
  const Box box;
  const result::Rival lying{box.model(), pose({0, 0, 700}, 0.0)};
  // One edge rests on the lying box's upper face, 20 mm up (towards the camera), well inside its outline.
  const result::Rival leaning{box.model(), pose({60, 5, 679.5}, -0.35)};
  CHECK(result::in_contact(lying, leaning, 4.0));
  CHECK(result::in_contact(leaning, lying, 4.0));
}

TEST_CASE("parts apart do not touch, however much one hides of the other", "[contact]") {
  const Box box;
  const result::Rival lying{box.model(), pose({0, 0, 700}, 0.0)};
  const double gap_mm = GENERATE(6.0, 30.0);
  const result::Rival above{box.model(), pose({0, 0, 700 - 20 - gap_mm}, 0.0)};
  const result::Rival beside{box.model(), pose({80 + gap_mm, 0, 700}, 0.0)};
  for (const auto& other : {above, beside}) {
    CHECK_FALSE(result::in_contact(lying, other, 4.0));
    CHECK_FALSE(result::in_contact(other, lying, 4.0));
  }
}
