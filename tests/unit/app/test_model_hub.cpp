#include <catch2/catch.hpp>

#include "app/model_hub.hpp"
#include "base/arena.hpp"
#include "small_cell.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

bool idle() { return true; }
bool busy() { return false; }

// A hub over memory of its own.
struct Hub {
  Log log;
  ArenaBlock block;
  Arena arena;
  ModelHub hub;

  explicit Hub(const Settings& settings)
      : block(measure(settings, log)), arena(block.data(), block.bytes()), hub(arena, settings, log) {}

  static std::size_t measure(const Settings& settings, Log& log) {
    Arena arena;
    const ModelHub hub(arena, settings, log);
    return arena.used_bytes();
  }
};

}  // namespace

TEST_CASE("the first recipe is active at start, another one when the PLC selects it", "[models]") {
  SmallCell cell;
  Hub with(cell.settings);
  ModelHub& hub = with.hub;
  int adopted = 0;
  hub.on_load([&](const Geometry&, LoadedRecipe&) {
    ++adopted;
    return Result<void>{};
  });
  const auto loaded = hub.load();
  INFO((loaded ? "" : loaded.error().detail));
  REQUIRE(loaded);
  CHECK(hub.code() == ResultCode::kOk);
  CHECK(hub.active_recipe() == 1);
  CHECK(hub.recipe().templates.front().name == "one");
  CHECK(hub.models().size() == 1);
  CHECK(hub.capture_time_us() > 0);
  CHECK(hub.offer_frame().frame == PoseFrame::kBelt);
  REQUIRE(hub.grasp(0, 0) != nullptr);
  CHECK(hub.grasp(0, 1) == nullptr);
  CHECK(hub.grasp(1, 0) == nullptr);
  CHECK_FALSE(hub.knows_recipe(3));

  hub.select_recipe(2);
  CHECK_FALSE(hub.idle());
  hub.serve(busy);  // while the pipeline works nothing is touched
  CHECK(hub.recipe().templates.front().name == "one");
  hub.serve(idle);
  CHECK(hub.idle());
  CHECK(hub.recipe().templates.front().name == "two");
  CHECK(adopted == 2);
}

TEST_CASE("a template larger than the limits blocks its recipe only", "[models]") {
  SmallCell cell;
  cell.settings.limits.template_points = 1000;
  Hub with(cell.settings);
  REQUIRE(with.hub.load());
  with.hub.select_recipe(2);
  with.hub.serve(idle);
  CHECK(with.hub.code() == ResultCode::kTemplateTooLarge);
  with.hub.select_recipe(1);
  with.hub.serve(idle);
  CHECK(with.hub.code() == ResultCode::kOk);
}

TEST_CASE("files read anew take effect once the cycle has let go of the old ones", "[models]") {
  SmallCell cell;
  Hub with(cell.settings);
  REQUIRE(with.hub.load());
  cell.write_recipe("first.json", 1, "two.template");
  with.hub.reload();
  CHECK_FALSE(with.hub.take_changed());  // nothing is held up while the new files are read
  with.hub.serve(idle);
  CHECK(with.hub.recipe().templates.front().name == "one");  // the cycle has not been told yet
  CHECK_FALSE(with.hub.idle());
  CHECK(with.hub.take_changed());
  with.hub.serve(idle);
  CHECK(with.hub.recipe().templates.front().name == "two");
  CHECK(with.hub.idle());
}

TEST_CASE("what does not fit together is refused by its code", "[models]") {
  SmallCell cell;
  SECTION("calibration of another size") {
    cell.settings.limits.image_width = 128;
    Hub with(cell.settings);
    CHECK(with.hub.load().error().code == ResultCode::kCalibrationMismatch);
    with.hub.check_camera("CAM1");
    CHECK(with.hub.code() == ResultCode::kCalibrationMismatch);
  }
  SECTION("no calibration") {
    cell.settings.calibration = "";
    Hub with(cell.settings);
    CHECK(with.hub.load().error().code == ResultCode::kNoCalibration);
    CHECK(with.hub.code() == ResultCode::kNoCalibration);
  }
  SECTION("cell of another calibration") {
    Cell other;
    other.calibration_id = "elsewhere";
    REQUIRE(contract_io::write_cell(cell.folder / "cell.json", other));
    Hub with(cell.settings);
    CHECK(with.hub.load().error().code == ResultCode::kCalibrationMismatch);
  }
  SECTION("another camera answers, then the right one") {
    Hub with(cell.settings);
    REQUIRE(with.hub.load());
    with.hub.check_camera("CAM2");
    CHECK(with.hub.code() == ResultCode::kCalibrationMismatch);
    with.hub.check_camera("CAM1");
    CHECK(with.hub.code() == ResultCode::kOk);
  }
  SECTION("a recipe number twice, or one that is not there") {
    cell.write_recipe("second.json", 1, "one.template");
    Hub with(cell.settings);
    CHECK(with.hub.load().error().code == ResultCode::kValueOutOfRange);
    cell.write_recipe("second.json", 2, "one.template");
    cell.settings.recipe = 7;
    Hub other(cell.settings);
    CHECK(other.hub.load().error().code == ResultCode::kRecipeUnknown);
  }
  SECTION("more frames than declared") {
    cell.settings.limits.frames = 4;
    Hub with(cell.settings);
    CHECK(with.hub.load().error().code == ResultCode::kLimitExceeded);
  }
}
