#include <catch2/catch.hpp>

#include "app/kept_models.hpp"
#include "app/model_hub.hpp"
#include "base/arena.hpp"
#include "contract_io/file_io.hpp"
#include "small_cell.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

bool idle() { return true; }

// A hub over the store of a cell; made anew it is the appliance after a restart.
struct KeptHub {
  Log log;
  std::vector<std::string> warnings;
  std::unique_ptr<KeptModels> kept;
  ArenaBlock block;
  Arena arena;
  ModelHub hub;
  int adopted = 0;

  explicit KeptHub(const Settings& settings)
      : kept(open(settings, warnings)),
        block(measure(settings, log)),
        arena(block.data(), block.bytes()),
        hub(arena, settings, log) {
    hub.use(kept->source(), kept->memory());
    hub.on_load([this](const Geometry&, LoadedRecipe&) {
      ++adopted;
      return Result<void>{};
    });
  }
  static std::unique_ptr<KeptModels> open(const Settings& settings, std::vector<std::string>& warnings) {
    auto kept = KeptModels::open(settings, warnings);
    INFO((kept ? "" : kept.error().detail));
    REQUIRE(kept);
    return std::move(*kept);
  }
  static std::size_t measure(const Settings& settings, Log& log) {
    Arena arena;
    const ModelHub hub(arena, settings, log);
    return arena.used_bytes();
  }
  void put(ItemKind kind, const std::string& name, const std::filesystem::path& file) {
    REQUIRE(kept->store().put(item_id(kind, name), *contract_io::read_file(file), "test"));
    hub.reload();
  }
  // The cycle's thread hears of the change; then the halves change places.
  void change() {
    hub.serve(idle);
    CHECK_FALSE(hub.idle());
    CHECK(hub.take_changed());
    hub.serve(idle);
    CHECK(hub.idle());
  }
  std::uint32_t version(ItemKind kind) {
    for (const auto& item : hub.in_use().items) {
      if (item.id.kind == kind) return item.version;
    }
    return 0;
  }
};

struct KeptCell : SmallCell {
  KeptCell() { settings.state = "state"; }
};

}  // namespace

TEST_CASE("the configuration's files fill the store once; after that the store counts", "[models]") {
  KeptCell cell;
  {
    KeptHub with(cell.settings);
    REQUIRE(with.hub.load());
    CHECK(with.warnings.empty());
    CHECK(with.kept->store().list().size() == 6);
    CHECK(with.kept->store().current(item_id(ItemKind::kTemplate, "one"))->origin == "import");
    CHECK(with.hub.recipe().templates.front().name == "one");
    CHECK(with.version(ItemKind::kCalibration) == 1);
  }
  cell.write_template("one.template", 700);
  std::filesystem::remove(cell.folder / "calibration.json");
  KeptHub again(cell.settings);
  REQUIRE(again.hub.load());
  CHECK(again.hub.recipe().templates.front().point_mm.size() == 600);
}

TEST_CASE("a look imports nothing, yet judges what would be imported", "[models]") {
  KeptCell cell;
  std::vector<std::string> warnings;
  const auto kept = KeptModels::look(cell.settings, warnings);
  REQUIRE(kept);
  CHECK_FALSE(std::filesystem::exists(cell.folder / "state"));
  CHECK(load_geometry((*kept)->source(), cell.settings, warnings)->calibration.id == "small");
  CHECK(list_recipes((*kept)->source(), warnings)->size() == 2);
}

TEST_CASE("an empty store says what to upload, and works when that is done", "[models]") {
  KeptCell cell;
  const auto files = cell.folder / "laptop";
  std::filesystem::create_directories(files);
  for (const char* name :
       {"calibration.json", "cell.json", "one.template", "two.template", "first.json", "second.json"})
    std::filesystem::rename(cell.folder / name, files / name);
  KeptHub with(cell.settings);
  CHECK(with.hub.load().error().code == ResultCode::kNoCalibration);
  with.put(ItemKind::kCalibration, "", files / "calibration.json");
  with.change();
  CHECK(with.hub.code() == ResultCode::kRecipeUnknown);
  with.put(ItemKind::kTemplate, "two", files / "two.template");
  REQUIRE(with.kept->store().put(item_id(ItemKind::kRecipe, "r"),
                                 R"({"format": "beltpick-recipe", "version": 1, "number": 4, "exposure_us": 5000,
                                     "sequence": "fast", "templates": ["two.template"]})",
                                 "test"));
  with.change();
  CHECK(with.hub.code() == ResultCode::kOk);
  CHECK(with.hub.active_recipe() == 4);
  CHECK(with.hub.in_use().recipe_name == "r");
  CHECK(with.hub.offer_frame().frame == PoseFrame::kCamera);
}

TEST_CASE("a restart comes back with the recipe that was selected, or with none", "[models]") {
  KeptCell cell;
  {
    KeptHub with(cell.settings);
    REQUIRE(with.hub.load());
    with.hub.select_recipe(2);
    with.hub.serve(idle);
    CHECK(with.hub.recipe().recipe.number == 2);
  }
  {
    KeptHub again(cell.settings);
    REQUIRE(again.hub.load());
    CHECK(again.hub.active_recipe() == 2);
    REQUIRE(again.kept->store().remove(item_id(ItemKind::kRecipe, "second"), "test"));
  }
  KeptHub without(cell.settings);
  CHECK(without.hub.load().error().code == ResultCode::kRecipeUnknown);
  CHECK(without.hub.active_recipe() == 2);
  without.hub.select_recipe(1);
  without.hub.serve(idle);
  CHECK(without.hub.code() == ResultCode::kOk);
}

TEST_CASE("what is uploaded is built while the cell runs on what it has; then the halves change places", "[models]") {
  KeptCell cell;
  KeptHub with(cell.settings);
  REQUIRE(with.hub.load());
  const auto* before = with.hub.models().data();
  cell.write_template("one.template", 900);
  with.put(ItemKind::kTemplate, "one", cell.folder / "one.template");
  bool locating = true;
  with.hub.serve([&] { return !locating; });
  CHECK(with.hub.take_changed());
  with.hub.serve([&] { return !locating; });
  CHECK(with.hub.models().data() == before);
  CHECK(with.hub.models().front().surface.size() == 600);
  CHECK_FALSE(with.hub.idle());  // no capture may start
  locating = false;
  with.hub.serve([&] { return !locating; });
  CHECK(with.hub.idle());
  CHECK(with.hub.models().data() != before);
  CHECK(with.hub.models().front().surface.size() == 900);
  CHECK(with.version(ItemKind::kTemplate) == 2);
  CHECK(with.adopted == 2);
}

TEST_CASE("an upload of what is not in use does not touch the cell", "[models]") {
  KeptCell cell;
  KeptHub with(cell.settings);
  REQUIRE(with.hub.load());
  cell.write_template("two.template", 2000);
  with.put(ItemKind::kTemplate, "two", cell.folder / "two.template");
  with.hub.serve(idle);
  CHECK(with.hub.idle());
  CHECK_FALSE(with.hub.take_changed());
  CHECK(with.adopted == 1);
  with.hub.select_recipe(2);
  with.hub.serve(idle);
  CHECK(with.hub.models().front().surface.size() == 2000);
}

TEST_CASE("a recipe selected while an upload waits is what comes into use", "[models]") {
  KeptCell cell;
  KeptHub with(cell.settings);
  REQUIRE(with.hub.load());
  cell.write_template("one.template", 900);
  with.put(ItemKind::kTemplate, "one", cell.folder / "one.template");
  with.hub.serve([] { return false; });
  CHECK(with.hub.take_changed());
  with.hub.select_recipe(2);
  with.hub.serve(idle);
  CHECK(with.hub.idle());
  CHECK(with.hub.recipe().recipe.number == 2);
  CHECK(with.hub.active_recipe() == 2);
  with.hub.select_recipe(2);  // what is in use already is not built again
  with.hub.serve(idle);
  CHECK(with.hub.idle());
  CHECK(with.adopted == 2);
}

TEST_CASE("a calibration that orphans the cell file stands with its code until the cell file follows", "[models]") {
  KeptCell cell;
  KeptHub with(cell.settings);
  REQUIRE(with.hub.load());
  std::vector<std::string> warnings;
  auto calibration = *contract_io::read_calibration(cell.folder / "calibration.json", warnings);
  calibration.id = "newer";
  REQUIRE(contract_io::write_calibration(cell.folder / "calibration.json", calibration));
  with.put(ItemKind::kCalibration, "", cell.folder / "calibration.json");
  with.change();
  CHECK(with.hub.code() == ResultCode::kCalibrationMismatch);
  Cell newer;
  newer.calibration_id = "newer";
  REQUIRE(contract_io::write_cell(cell.folder / "cell.json", newer));
  with.put(ItemKind::kCell, "", cell.folder / "cell.json");
  with.change();
  CHECK(with.hub.code() == ResultCode::kOk);
  CHECK(with.hub.geometry().calibration.id == "newer");
}
