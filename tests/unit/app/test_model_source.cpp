// Where models come from: the store, and what a damaged version in it means.
#include <unistd.h>
#include <catch2/catch.hpp>
#include <fstream>

#include "app/loaded_recipe.hpp"
#include "app/model_source.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;
using namespace beltpick::app;

namespace {

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("beltpick_model_source_" + std::to_string(getpid()));
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }

  [[nodiscard]] service::Store open() const {
    std::vector<std::string> warnings;
    auto store = service::Store::open(path, warnings);
    REQUIRE(store);
    return std::move(*store);
  }
};

}  // namespace

TEST_CASE("a damaged newest version is not quietly replaced by the one before", "[models]") {
  const Folder folder;
  const service::ItemId id = item_id(ItemKind::kCalibration);
  {
    service::Store store = folder.open();
    REQUIRE(store.put(id, "before the camera was moved", "test"));
    REQUIRE(store.put(id, "after it was moved", "test"));
  }
  std::ofstream(folder.path / "calibration" / "calibration" / "00000002.item", std::ios::app) << "rot";
  service::Store store = folder.open();
  const StoreSource source(store);
  const auto refused = source.get(id);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ResultCode::kChecksumWrong);
  CHECK(refused.error().text().find("version 2") != std::string_view::npos);

  SECTION("uploaded again it is there") {
    REQUIRE(store.put(id, "after it was moved", "test"));
    REQUIRE(source.get(id));
    CHECK(source.get(id)->bytes == "after it was moved");
  }
  SECTION("a person may go back to the one before") {
    const auto previous = store.previous(id);
    REQUIRE(previous);
    CHECK(*previous == 1);
    const auto version = store.get(id, *previous);
    REQUIRE(version);
    const auto put = store.put(id, version->bytes, "test", "rollback to 1");
    REQUIRE(put);
    CHECK(put->version == 3);
    REQUIRE(source.get(id));
    CHECK(source.get(id)->bytes == "before the camera was moved");
  }
}

TEST_CASE("a damaged recipe does not keep the others from being run", "[models]") {
  const Folder folder;
  const auto recipe = [](int number) {
    return R"({"format": "beltpick-recipe", "version": 1, "number": )" + std::to_string(number) +
           R"(, "exposure_us": 5000, "templates": ["one"]})";
  };
  {
    service::Store store = folder.open();
    REQUIRE(store.put(item_id(ItemKind::kRecipe, "damaged"), recipe(1), "test"));
    REQUIRE(store.put(item_id(ItemKind::kRecipe, "damaged"), recipe(1) + "\n", "test"));
    REQUIRE(store.put(item_id(ItemKind::kRecipe, "whole"), recipe(2), "test"));
  }
  std::ofstream(folder.path / "recipe" / "damaged" / "00000002.item", std::ios::app) << "rot";
  service::Store store = folder.open();
  std::vector<std::string> warnings;
  const auto listed = list_recipes(StoreSource(store), warnings);
  REQUIRE(listed);
  REQUIRE(listed->size() == 1);
  CHECK(listed->front().recipe.number == 2);
  REQUIRE_FALSE(warnings.empty());
  CHECK(warnings.front().find("recipe 'damaged'") != std::string::npos);
}
