#include <catch2/catch.hpp>

#include "app/loaded_recipe.hpp"
#include "app/projector_choice.hpp"
#include "contract/flash_plan.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

// A recipe of a named sequence for a projector of 912x1140 pixels.
Result<LoadedRecipe> planned(const Settings& settings, const char* sequence, double exposure_us, double period_us) {
  Calibration calibration;
  calibration.camera = {64, 48, 80, 80, 32, 24, {}};
  calibration.projector = {lcr4500::kWidth, lcr4500::kHeight, 1000, 1000, 456, 570, {}};
  calibration.T_projector_camera.translation_mm = {200, 0, 0};
  ListedRecipe listed;
  listed.recipe.sequence = sequence;
  listed.recipe.exposure_us = exposure_us;
  listed.recipe.period_us = period_us;
  std::vector<std::string> warnings;
  return plan_recipe(listed, settings, calibration, warnings);
}

Settings with(const char* kind) {
  Settings settings;
  settings.limits.image_width = 64;
  settings.limits.image_height = 48;
  settings.projector_kind = kind;
  return settings;
}

std::uint32_t longest_period_us(const LoadedRecipe& loaded) {
  std::uint32_t longest_us = 0;
  for (int i = 0; i < loaded.plan.timing.group_count; ++i) {
    longest_us = std::max(longest_us, loaded.plan.timing.groups[i].period_us);
  }
  return longest_us;
}

}  // namespace

TEST_CASE("the configuration names the driver", "[projector]") {
  CHECK(make_projector(with("edge"))->facts().name == "any that advances on an edge");
  CHECK(make_projector(with("lightcrafter4500"))->facts().name == "LightCrafter 4500");
  CHECK(make_projector(with("display"))->facts().name == "display");
  CHECK(make_projector(with("display"))->leads());
  CHECK_FALSE(make_projector(with("lightcrafter4500"))->leads());
}

TEST_CASE("an edge asks nothing of a recipe", "[projector]") {
  const auto loaded = planned(with("edge"), "standard", 5000, 25'000);
  REQUIRE(loaded);
  CHECK(loaded->plan.timing.group_count == 1);
  CHECK(longest_period_us(*loaded) == 25'000);
  CHECK(loaded->sequence.projector.layout == ProjectorLayout::kSquare);
}

TEST_CASE("a LightCrafter's fast sequence keeps its period, a longer one waits while an image loads", "[projector]") {
  const Settings settings = with("lightcrafter4500");
  const auto fast = planned(settings, "fast", 9000, 25'000);
  REQUIRE(fast);
  CHECK(fast->plan.timing.group_count == 1);
  CHECK(fast->sequence.projector.layout == ProjectorLayout::kDiamond);
  CHECK(fast->show.shortest_period_us == 25'000);
  const auto standard = planned(settings, "standard", 9000, 25'000);
  REQUIRE(standard);
  const protocol::Arm& arm = standard->plan.timing;
  REQUIRE(arm.group_count == 3);
  CHECK(arm.groups[0].frames == 3);
  CHECK(arm.groups[1].frames == 3);  // of the second image, while the third is loaded
  CHECK(arm.groups[1].frames * arm.groups[1].period_us >= lcr4500::kImageLoad_us);
  CHECK(arm.groups[2].period_us == 25'000);
  CHECK(standard->plan.duration_us > fast->plan.duration_us + 100'000);
  CHECK(planned(settings, "robust", 9000, 25'000));
}

TEST_CASE("what a LightCrafter cannot show is refused when the recipe is loaded, with what it needs", "[projector]") {
  const auto dim = planned(with("lightcrafter4500"), "fast", 5000, 25'000);
  REQUIRE_FALSE(dim);
  CHECK(dim.error().code == ResultCode::kValueOutOfRange);
  CHECK(dim.error().text().find("exposure_us: expected at least 8533") != std::string_view::npos);
}

TEST_CASE("a display takes the time of its frames and its latency", "[projector]") {
  Settings settings = with("display");
  settings.projector_latency_us = 40'000;
  const auto loaded = planned(settings, "fast", 8000, 25'000);
  REQUIRE(loaded);
  CHECK(longest_period_us(*loaded) >= 40'000 + 8000 + 2 * 16'667);
}
