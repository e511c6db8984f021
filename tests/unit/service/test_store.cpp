// What the store promises its callers: versions, history, removal, limits, one process at a time.
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <numeric>
#include <thread>

#include "contract/result_codes.hpp"
#include "service/sha256.hpp"
#include "unit/service/store_support.hpp"

namespace beltpick::test {
namespace {

using service::ItemId;
using service::VersionInfo;
using Numbers = std::vector<std::uint32_t>;

TEST_CASE("SHA-256 of the standard's examples") {
  CHECK(service::sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(service::sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_CASE("a new store is empty; its folder is made with its parents") {
  const TempFolder temp;
  Opened store(temp / "a/b/store");
  CHECK(store->list().empty());
  CHECK_FALSE(store->current(kKnuckle));
  CHECK(store->versions(kKnuckle).empty());
  CHECK(store->get(kKnuckle).error().code == ResultCode::kFileNotFound);
  CHECK(store.warnings.empty());
}

TEST_CASE("what was put comes back, also after opening anew") {
  const TempFolder temp;
  const std::string bytes = seeded_bytes(1, 5000);
  VersionInfo put;
  {
    Opened store(temp.path());
    put = store->put(kKnuckle, bytes, "anna", "upload").value();
    CHECK(put.version == 1);
    CHECK(put.bytes == 5000);
    CHECK(put.sha256 == service::sha256_hex(bytes));
    CHECK(put.by == "anna");
    CHECK(put.origin == "upload");
    CHECK(put.time_utc.size() == 20);
    CHECK(store->get(kKnuckle)->bytes == bytes);
  }
  Opened store(temp.path());
  CHECK(store.warnings.empty());
  CHECK(store->current(kKnuckle) == put);
  CHECK(store->list() == std::vector<ItemId>{kKnuckle});
  const auto got = store->get(kKnuckle);
  REQUIRE(got);
  CHECK(got->bytes == bytes);
  CHECK(got->info == put);
}

TEST_CASE("empty bytes and the largest allowed are items; one byte more is refused") {
  const TempFolder temp;
  const ItemId cell{ItemKind::kCell, "cell"};
  const std::size_t most = item_kind(ItemKind::kCell).max_bytes;
  Opened store(temp.path());
  CHECK(store->put(cell, "", "t")->bytes == 0);
  CHECK(store->put(cell, seeded_bytes(2, most), "t")->version == 2);
  CHECK(store->put(cell, seeded_bytes(3, most + 1), "t").error().code == ResultCode::kLimitExceeded);
  CHECK(store->get(cell)->bytes.size() == most);
}

TEST_CASE("the last ten versions are kept, each with its bytes") {
  const TempFolder temp;
  const auto check = [](Opened& store) {
    Numbers expected(10);
    std::iota(expected.begin(), expected.end(), 4);
    CHECK(numbers(store->versions(kKnuckle)) == expected);
    for (const std::uint32_t version : expected) {
      CHECK(store->get(kKnuckle, version)->bytes == seeded_bytes(version, 100));
    }
    CHECK(store->get(kKnuckle, 3).error().code == ResultCode::kFileNotFound);
    CHECK(store->get(kKnuckle, 14).error().code == ResultCode::kFileNotFound);
  };
  {
    Opened store(temp.path());
    for (std::uint32_t version = 1; version <= 13; ++version) {
      CHECK(store->put(kKnuckle, seeded_bytes(version, 100), "t")->version == version);
    }
    check(store);
  }
  Opened again(temp.path());
  check(again);
}

TEST_CASE("the current version's bytes once more are no new version; an older one's are") {
  const TempFolder temp;
  Opened store(temp.path());
  const VersionInfo first = store->put(kKnuckle, "one", "t").value();
  CHECK(store->put(kKnuckle, "one", "another").value() == first);
  CHECK(store->put(kKnuckle, "two", "t")->version == 2);
  CHECK(store->put(kKnuckle, "one", "t", "rollback to 1")->version == 3);
  CHECK(store->current(kKnuckle)->origin == "rollback to 1");
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{1, 2, 3});
}

TEST_CASE("a removed item is out of the list, keeps its versions and can come back") {
  const TempFolder temp;
  {
    Opened store(temp.path());
    REQUIRE(store->put(kKnuckle, "one", "t"));
    const VersionInfo removal = store->remove(kKnuckle, "anna").value();
    CHECK(removal.removed);
    CHECK(removal.version == 2);
    CHECK(removal.origin == "removed");
  }
  Opened store(temp.path());
  CHECK(store->list().empty());
  CHECK_FALSE(store->current(kKnuckle));
  CHECK(numbers(store->versions(kKnuckle)) == Numbers{1, 2});
  CHECK(store->get(kKnuckle).error().code == ResultCode::kFileNotFound);
  CHECK(store->get(kKnuckle, 2).error().code == ResultCode::kFileNotFound);
  CHECK(store->get(kKnuckle, 1)->bytes == "one");
  CHECK(store->remove(kKnuckle, "t").error().code == ResultCode::kFileNotFound);
  CHECK(store->previous(kKnuckle).value() == 1);
  CHECK(store->put(kKnuckle, store->get(kKnuckle, 1)->bytes, "t", "rollback to 1")->version == 3);
  CHECK(store->get(kKnuckle)->bytes == "one");
}

TEST_CASE("a removal of what is not there, and of what a cell cannot do without, is refused") {
  const TempFolder temp;
  Opened store(temp.path());
  CHECK(store->remove(kKnuckle, "t").error().code == ResultCode::kFileNotFound);
  REQUIRE(store->put(kCalibrationItem, "c", "t"));
  CHECK(store->remove(kCalibrationItem, "t").error().code == ResultCode::kUsage);
  CHECK(store->current(kCalibrationItem)->version == 1);
}

TEST_CASE("going back without a number goes to the version before") {
  const TempFolder temp;
  Opened store(temp.path());
  CHECK(store->previous(kKnuckle).error().code == ResultCode::kFileNotFound);
  REQUIRE(store->put(kKnuckle, "one", "t"));
  CHECK(store->previous(kKnuckle).error().code == ResultCode::kFileNotFound);
  REQUIRE(store->put(kKnuckle, "two", "t"));
  CHECK(store->previous(kKnuckle).value() == 1);
  REQUIRE(store->remove(kKnuckle, "t"));
  REQUIRE(store->put(kKnuckle, "four", "t"));
  CHECK(store->previous(kKnuckle).value() == 2);
}

TEST_CASE("a name that could leave the folder is refused, and nothing is written") {
  const TempFolder temp;
  {
    Opened store(temp / "store");
    for (const std::string name : {"", ".", "..", "../x", "a/b", ".hidden", "a\\b", "a b", "\xc3\xa4", "-x"}) {
      INFO(name);
      const ItemId id{ItemKind::kTemplate, name};
      CHECK(store->put(id, "x", "t").error().code == ResultCode::kUsage);
      CHECK(store->get(id).error().code == ResultCode::kFileNotFound);
      CHECK(store->remove(id, "t").error().code == ResultCode::kFileNotFound);
    }
    CHECK(store->put({ItemKind::kTemplate, std::string(65, 'a')}, "x", "t").error().code == ResultCode::kUsage);
    CHECK(store->put({ItemKind::kTemplate, std::string("a\0b", 3)}, "x", "t").error().code == ResultCode::kUsage);
    CHECK(store->put({ItemKind::kCalibration, "other"}, "x", "t").error().code == ResultCode::kUsage);
    CHECK(store->put({ItemKind::kTemplate, std::string(64, 'a')}, "x", "t"));
  }
  for (const auto& entry : std::filesystem::directory_iterator(temp.path())) CHECK(entry.path().filename() == "store");
}

TEST_CASE("items are listed in order of kind and name; equal names of two kinds are two items") {
  const TempFolder temp;
  const std::vector<ItemId> ids{{ItemKind::kCalibration, "calibration"},
                                {ItemKind::kTemplate, "a"},
                                {ItemKind::kTemplate, "b"},
                                {ItemKind::kRecipe, "a"}};
  Opened store(temp.path());
  for (auto id = ids.rbegin(); id != ids.rend(); ++id) {
    REQUIRE(store->put(*id, std::string(item_kind(id->kind).name) + id->name, "t"));
  }
  CHECK(store->list() == ids);
  CHECK(store->get(ids[1])->bytes == "templatea");
  CHECK(store->get(ids[3])->bytes == "recipea");
}

TEST_CASE("whatever stands in `by` and `origin`, the file stays readable") {
  const TempFolder temp;
  const std::string awkward = std::string("a\"\\\n\0\x80\xff{}", 10) + std::string(5000, '\x01');
  VersionInfo put;
  {
    Opened store(temp.path());
    put = store->put(kKnuckle, "x", awkward, awkward).value();
    CHECK(put.by.find('\n') == std::string::npos);
  }
  Opened store(temp.path());
  CHECK(store.warnings.empty());
  CHECK(store->current(kKnuckle) == put);
}

TEST_CASE("a folder is one store's at a time") {
  const TempFolder temp;
  {
    Opened store(temp.path());
    std::vector<std::string> warnings;
    const auto second = service::Store::open(temp.path(), warnings);
    REQUIRE_FALSE(second);
    CHECK(second.error().code == ResultCode::kFileNotWritten);
    CHECK(second.error().text().find("another process") != std::string_view::npos);
  }
  Opened again(temp.path());
  const pid_t child = fork();
  if (child == 0) {
    std::vector<std::string> warnings;
    _exit(service::Store::open(temp.path(), warnings) ? 1 : 0);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
}

TEST_CASE("threads putting at once: every version is there, in one order, whole") {
  const TempFolder temp;
  Opened store(temp.path(), 100);
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&store, t] {
      for (std::uint32_t i = 0; i < 10; ++i) {
        (void)store->put(kKnuckle, std::to_string(t * 100 + i), "t", std::to_string(t * 100 + i));
        (void)store->get(kKnuckle);
        (void)store->list();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto versions = store->versions(kKnuckle);
  REQUIRE(versions.size() == 40);
  for (std::uint32_t i = 0; i < 40; ++i) {
    CHECK(versions[i].version == i + 1);
    CHECK(store->get(kKnuckle, i + 1)->bytes == versions[i].origin);
  }
}

}  // namespace
}  // namespace beltpick::test
