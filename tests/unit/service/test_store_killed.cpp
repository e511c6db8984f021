// The store under kill -9: at random moments, before and after each call that changes the disk, and within each write;
// under a disk that fails at each call; and after a power cut at each. Always the old or the new version, whole, and
// the whole history. bench_store_torture does the same at length.
#include <catch2/catch.hpp>

#include "support/store/faults.hpp"
#include "support/store/killing.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::test {
namespace {

constexpr std::size_t kItemBytes = 40;

TEST_CASE("kill -9 at random") {
  for (const std::filesystem::path& parent : {std::filesystem::temp_directory_path(), memory_folder()}) {
    const TempFolder temp(parent);
    const KillingCounts counts = kill_at_random(temp / "store", {.kills = 40, .seed = 1});
    CHECK(counts.trouble == "");
    CHECK(counts.kills == 40);
    CHECK(counts.acknowledged > 10);
    CHECK(counts.hit > 3);
  }
}

TEST_CASE("kill -9 before and after every call") {
  const TempFolder temp(memory_folder());
  for (const DisturbedStep& step : disturbed_steps(kItemBytes)) {
    const FaultCounts counts = kill_at_every_call(temp / "store", step);
    CHECK(counts.trouble == "");
    CHECK(counts.cases >= 10);
    CHECK(counts.came_new > 0);
    CHECK(counts.came_new < counts.cases);
  }
}

TEST_CASE("kill -9 after every byte") {
  const TempFolder temp(memory_folder());
  const DisturbedStep step = disturbed_steps(kItemBytes)[2];
  const FaultCounts counts = kill_at_every_byte(temp / "store", step);
  CHECK(counts.trouble == "");
  CHECK(counts.cases > 200);
  CHECK(counts.came_new == 0);
}

TEST_CASE("every call fails") {
  const TempFolder temp(memory_folder());
  for (const DisturbedStep& step : disturbed_steps(kItemBytes)) {
    const FaultCounts counts = fail_at_every_call(temp / "store", step);
    CHECK(counts.trouble == "");
    CHECK(counts.cases >= 8 * 6);
  }
}

TEST_CASE("no room for any byte") {
  const TempFolder temp(memory_folder());
  const FaultCounts counts = limit_at_every_byte(temp / "store", disturbed_steps(kItemBytes)[1]);
  CHECK(counts.trouble == "");
  CHECK(counts.cases > 200);
}

TEST_CASE("power cut after every call") {
  const TempFolder temp(memory_folder());
  for (const DisturbedStep& step : disturbed_steps(kItemBytes)) {
    const FaultCounts counts = cut_power_at_every_call(temp / "store", step, 1);
    CHECK(counts.trouble == "");
    CHECK(counts.cases > 200);
    CHECK(counts.came_new > 0);
  }
}

TEST_CASE("a power cut at every upload") {
  const TempFolder temp(memory_folder());
  const FaultCounts counts = cut_power_again_and_again(temp / "store", 100, 1);
  CHECK(counts.trouble == "");
  CHECK(counts.cases == 100);
  CHECK(counts.came_new > 20);
  CHECK(counts.came_new < 80);
}

TEST_CASE("the newest file cut at every byte, and each of its bits flipped") {
  const TempFolder temp(memory_folder());
  const FaultCounts counts = damage_every_byte(temp / "store", disturbed_steps(kItemBytes)[2], 1);
  CHECK(counts.trouble == "");
  CHECK(counts.cases > 9 * 200);
}

}  // namespace
}  // namespace beltpick::test
