// What the self-test finds out about the store.
#include <catch2/catch.hpp>

#include "contract/result_codes.hpp"
#include "service/store_facts.hpp"
#include "unit/service/store_support.hpp"

namespace beltpick::test {
namespace {

TEST_CASE("a good store, also while somebody has it: its items, the calibration's age") {
  const TempFolder temp;
  Opened store(temp.path());
  REQUIRE(store->put(kKnuckle, "k", "t"));
  CHECK_FALSE(service::find_store(temp.path()).calibration_age_days);
  REQUIRE(store->put(kCalibrationItem, "c", "t"));
  const service::StoreFound found = service::find_store(temp.path());
  CHECK(found.configured);
  CHECK(found.problem.code == ResultCode::kOk);
  CHECK(found.items == 2);
  CHECK(found.damaged == "");
  REQUIRE(found.calibration_age_days);
  CHECK(std::abs(*found.calibration_age_days) < 0.1);
}

TEST_CASE("a damaged newest version is found before and after the store was opened") {
  const TempFolder temp;
  {
    Opened store(temp.path());
    REQUIRE(store->put(kKnuckle, "1", "t"));
    REQUIRE(store->put(kKnuckle, "2", "t"));
  }
  (void)temp.file("template/knuckle/00000002.item", "rubbish");
  CHECK(service::find_store(temp.path()).damaged == "template knuckle: version 2 is damaged, version 1 is used");
  (void)Opened(temp.path());
  CHECK(service::find_store(temp.path()).damaged == "template knuckle: version 2 is damaged, version 1 is used");
}

TEST_CASE("a store that is not there has no items; a file in its place is a problem") {
  const TempFolder temp;
  CHECK(service::find_store(temp / "nothing").items == 0);
  CHECK(service::find_store(temp.file("file", "x")).problem.code == ResultCode::kFileUnreadable);
}

}  // namespace
}  // namespace beltpick::test
