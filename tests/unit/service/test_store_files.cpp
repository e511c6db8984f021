// What stands in the store's folder and should not: foreign files, copies in wrong places, links that lead elsewhere,
// leftovers, a newer form; and what a damaged version means for what comes after.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "unit/service/store_support.hpp"

namespace beltpick::test {
namespace {

namespace fs = std::filesystem;
using service::ItemId;
using Numbers = std::vector<std::uint32_t>;

const ItemId kWasher{ItemKind::kTemplate, "washer"};

// A store with `versions` versions of the knuckle, "1", "2", ...
void fill(const fs::path& folder, std::uint32_t versions) {
  Opened store(folder);
  for (std::uint32_t i = 1; i <= versions; ++i) REQUIRE(store->put(kKnuckle, std::to_string(i), "t"));
}

bool warned_of(const Opened& store, const std::string& text) {
  return std::ranges::any_of(store.warnings, [&](const std::string& warning) { return warning.contains(text); });
}

void overwrite(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

TEST_CASE("a damaged newest version is set aside, told, and its number not given again") {
  const TempFolder temp;
  fill(temp.path(), 3);
  const fs::path file = version_file(temp.path(), kKnuckle, 3);
  overwrite(file, file_bytes(file) + "x");
  for (int opening = 0; opening < 2; ++opening) {
    Opened store(temp.path());
    CHECK(store.warnings.size() == (opening == 0 ? 1 : 0));
    CHECK(warned_of(store, "00000003.item") == (opening == 0));
    CHECK(fs::exists(file.string() + ".damaged"));
    CHECK_FALSE(fs::exists(file));
    CHECK(store->get(kKnuckle)->bytes == "2");
    REQUIRE(store->fallbacks().size() == 1);
    CHECK(store->fallbacks()[0].id == kKnuckle);
    CHECK(store->fallbacks()[0].damaged == 3);
  }
  Opened store(temp.path());
  CHECK(store->put(kKnuckle, "4", "t")->version == 4);
  CHECK(store->fallbacks().empty());
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{1, 2, 4});
}

TEST_CASE("a damaged older version is set aside; the newest stays, and it goes with its age") {
  const TempFolder temp;
  fill(temp.path(), 4);
  overwrite(version_file(temp.path(), kKnuckle, 2), "");
  Opened store(temp.path(), 3);
  CHECK(warned_of(store, "00000002.item"));
  CHECK(store->fallbacks().empty());
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{1, 3, 4});
  REQUIRE(store->put(kKnuckle, "5", "t"));
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{3, 4, 5});
  CHECK_FALSE(fs::exists(version_file(temp.path(), kKnuckle, 2).string() + ".damaged"));
}

TEST_CASE("with its only version damaged an item is not there, and comes back with the next number") {
  const TempFolder temp;
  fill(temp.path(), 1);
  overwrite(version_file(temp.path(), kKnuckle, 1), "rubbish");
  Opened store(temp.path());
  CHECK(store->list().empty());
  CHECK(store->fallbacks().size() == 1);
  CHECK(store->get(kKnuckle).error().code == ResultCode::kFileNotFound);
  CHECK(store->put(kKnuckle, "new", "t")->version == 2);
}

TEST_CASE("a version that is damaged while the store is open is not handed out, and is written anew") {
  const TempFolder temp;
  Opened store(temp.path());
  REQUIRE(store->put(kKnuckle, "one", "t"));
  const fs::path file = version_file(temp.path(), kKnuckle, 1);
  std::string bytes = file_bytes(file);
  bytes.back() = 'X';
  overwrite(file, bytes);
  CHECK(store->get(kKnuckle).error().code == ResultCode::kChecksumWrong);
  CHECK(store->put(kKnuckle, "one", "t")->version == 2);
  CHECK(store->get(kKnuckle)->bytes == "one");
  fs::remove(version_file(temp.path(), kKnuckle, 2));
  CHECK(store->get(kKnuckle).error().code == ResultCode::kFileUnreadable);
}

TEST_CASE("a whole folder that vanished while the store is open is made again") {
  const TempFolder temp;
  Opened store(temp.path());
  REQUIRE(store->put(kKnuckle, "one", "t"));
  fs::remove_all(temp / "template");
  CHECK(store->get(kKnuckle).error().code == ResultCode::kFileUnreadable);
  CHECK(store->put(kKnuckle, "two", "t")->version == 2);
  CHECK(store->get(kKnuckle)->bytes == "two");
}

TEST_CASE("a version copied to another number or another item does not count there") {
  const TempFolder temp;
  fill(temp.path(), 2);
  fs::copy_file(version_file(temp.path(), kKnuckle, 1), version_file(temp.path(), kKnuckle, 3));
  fs::create_directories(version_file(temp.path(), kWasher, 1).parent_path());
  fs::copy_file(version_file(temp.path(), kKnuckle, 1), version_file(temp.path(), kWasher, 1));
  Opened store(temp.path());
  CHECK(store.warnings.size() == 2);
  CHECK(store->list() == std::vector<ItemId>{kKnuckle});
  CHECK(store->get(kKnuckle)->bytes == "2");
}

TEST_CASE("files of nobody's are left alone with a warning; leftovers of a write go") {
  const TempFolder temp;
  fill(temp.path(), 1);
  const fs::path folder = version_file(temp.path(), kKnuckle, 1).parent_path();
  for (const char* name :
       {"notes.txt", "00000002.item~", "2.item", "000000002.item", "0000000x.item", "00000000.item"}) {
    overwrite(folder / name, "x");
  }
  overwrite(folder / "00000002.part", "beltpick-item 1 half");
  overwrite(temp / "template/file", "x");
  fs::create_directory(temp / "template/.hidden");
  fs::create_directories(temp / "calibration/other");
  Opened store(temp.path());
  CHECK(store.warnings.size() == 10);
  CHECK(warned_of(store, "notes.txt"));
  CHECK(warned_of(store, "interrupted"));
  CHECK(fs::exists(folder / "notes.txt"));
  CHECK_FALSE(fs::exists(folder / "00000002.part"));
  CHECK(store->list() == std::vector<ItemId>{kKnuckle});
  CHECK(store->put(kKnuckle, "2", "t")->version == 2);
}

TEST_CASE("a file of a newer form is left as it is and does not count") {
  const TempFolder temp;
  fill(temp.path(), 2);
  const fs::path file = version_file(temp.path(), kKnuckle, 2);
  overwrite(file, "beltpick-item 2 of a beltpick to come");
  Opened store(temp.path());
  CHECK(warned_of(store, "update beltpick"));
  CHECK(fs::exists(file));
  CHECK(store->get(kKnuckle)->bytes == "1");
  CHECK(store->put(kKnuckle, "3", "t")->version == 3);
}

TEST_CASE("a file too large for its kind, a folder, a link and a pipe are no versions; none is read, none waited for") {
  const TempFolder temp;
  fill(temp.path(), 1);
  const auto place = [&](std::uint32_t version) { return version_file(temp.path(), kKnuckle, version); };
  overwrite(place(2), "x");
  fs::resize_file(place(2), std::uintmax_t{1} << 40U);  // sparse
  fs::create_directory(place(3));
  fs::create_symlink(place(1), place(4));
  REQUIRE(mkfifo(place(5).c_str(), 0600) == 0);
  Opened store(temp.path());
  CHECK(store.warnings.size() == 4);
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{1});
  CHECK(store->put(kKnuckle, "6", "t")->version == 6);
}

TEST_CASE("no symbolic link in the folder leads anywhere") {
  const TempFolder temp;
  const fs::path outside = temp / "outside";
  fs::create_directories(outside / "washer");
  fs::create_directories(temp / "store/template");
  fs::create_directory_symlink(outside / "washer", temp / "store/template/washer");
  fs::create_directory_symlink(outside, temp / "store/recipe");
  Opened store(temp / "store");
  CHECK(store.warnings.size() == 2);
  CHECK(store->put(kWasher, "x", "t").error().code == ResultCode::kFileNotWritten);
  CHECK(store->put({ItemKind::kRecipe, "r"}, "x", "t").error().code == ResultCode::kFileNotWritten);
  CHECK(store->put(kKnuckle, "x", "t"));
  CHECK(fs::is_empty(outside / "washer"));
  CHECK(std::distance(fs::directory_iterator(outside), {}) == 1);
}

TEST_CASE("a link in the place of the temporary is not written through") {
  const TempFolder temp;
  const fs::path victim = temp.file("victim", "precious");
  Opened store(temp / "store");
  REQUIRE(store->put(kKnuckle, "one", "t"));
  fs::create_symlink(victim, version_file(temp / "store", kKnuckle, 2).replace_extension(".part"));
  CHECK(store->put(kKnuckle, "two", "t").error().code == ResultCode::kFileNotWritten);
  CHECK(file_bytes(victim) == "precious");
  CHECK(store->put(kKnuckle, "two", "t")->version == 2);
}

TEST_CASE("the store's own folder may be a link, but must be a folder that can be written") {
  const TempFolder temp;
  fs::create_directory(temp / "real");
  fs::create_directory_symlink(temp / "real", temp / "link");
  {
    Opened store(temp / "link");
    REQUIRE(store->put(kKnuckle, "one", "t"));
  }
  CHECK(Opened(temp / "real")->get(kKnuckle)->bytes == "one");
  std::vector<std::string> warnings;
  const auto not_a_folder = service::Store::open(temp.file("file", "x"), warnings);
  REQUIRE_FALSE(not_a_folder);
  CHECK(not_a_folder.error().code == ResultCode::kFileNotWritten);
}

TEST_CASE("when the numbers are used up, that is said, and nothing is lost") {
  const TempFolder temp;
  fill(temp.path(), 1);
  overwrite(version_file(temp.path(), kKnuckle, 99'999'999), "rubbish");
  Opened store(temp.path());
  CHECK(store->put(kKnuckle, "x", "t").error().code == ResultCode::kLimitExceeded);
  CHECK(store->get(kKnuckle)->bytes == "1");
}

TEST_CASE("a store can be looked at while another has it, and nothing is changed") {
  const TempFolder temp;
  fill(temp.path(), 12);
  Opened owner(temp.path());
  const fs::path newest = version_file(temp.path(), kKnuckle, 12);
  overwrite(newest, "rubbish");
  overwrite(fs::path(newest).replace_filename("00000013.part"), "being written");
  std::vector<std::string> warnings;
  auto looked = service::Store::look(temp.path(), warnings);
  REQUIRE(looked);
  CHECK(warnings.size() == 1);
  CHECK(looked->list() == std::vector<ItemId>{kKnuckle});
  CHECK(looked->get(kKnuckle)->bytes == "11");
  CHECK(looked->fallbacks().size() == 1);
  CHECK(looked->put(kKnuckle, "x", "t").error().code == ResultCode::kUsage);
  CHECK(looked->put(kWasher, "x", "t").error().code == ResultCode::kUsage);
  CHECK(looked->remove(kKnuckle, "t").error().code == ResultCode::kUsage);
  CHECK(fs::exists(newest));
  CHECK(fs::exists(fs::path(newest).replace_filename("00000013.part")));
  CHECK(owner->put(kKnuckle, "13", "t")->version == 13);
}

TEST_CASE("a store that is not there is an empty one to who looks, and is not made") {
  const TempFolder temp;
  std::vector<std::string> warnings;
  auto looked = service::Store::look(temp / "nothing", warnings);
  REQUIRE(looked);
  CHECK(looked->list().empty());
  CHECK(looked->put(kKnuckle, "x", "t").error().code == ResultCode::kUsage);
  CHECK_FALSE(fs::exists(temp / "nothing"));
  CHECK(service::Store::look(temp.file("file", "x"), warnings).error().code == ResultCode::kFileUnreadable);
}

TEST_CASE("gaps in the numbers stay") {
  const TempFolder temp;
  fill(temp.path(), 4);
  fs::remove(version_file(temp.path(), kKnuckle, 2));
  Opened store(temp.path());
  CHECK(store.warnings.empty());
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{1, 3, 4});
  CHECK(store->put(kKnuckle, "5", "t")->version == 5);
}

TEST_CASE("there is a limit to the number of items, not to the versions of those that are there") {
  const TempFolder temp(memory_folder());
  {
    Opened store(temp.path());
    for (std::size_t i = 0; i < service::Store::kMaxItems; ++i) {
      REQUIRE(store->put({ItemKind::kRecipe, "r" + std::to_string(i)}, "x", "t"));
    }
  }
  Opened store(temp.path());
  CHECK(store->list().size() == service::Store::kMaxItems);
  CHECK(store->put({ItemKind::kRecipe, "one-more"}, "x", "t").error().code == ResultCode::kLimitExceeded);
  CHECK(store->put({ItemKind::kRecipe, "r7"}, "y", "t")->version == 2);
  CHECK(store->put(kKnuckle, "another kind", "t"));
}

}  // namespace
}  // namespace beltpick::test
