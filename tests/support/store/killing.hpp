// kill -9 at random moments of a process that puts versions into a store without pause.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace beltpick::test {

struct KillingPlan {
  int kills = 60;
  int uploads = 0;  // at least as many are begun, however many kills that takes
  std::uint32_t seed = 1;
  std::size_t max_bytes = 200'000;  // of an item
};

struct KillingCounts {
  std::string trouble;  // what was not as it must be; empty: nothing
  int kills = 0;
  int uploads = 0;  // begun
  int acknowledged = 0;
  int hit = 0;            // kills that came while a version was written
  int came_new = 0;       // of those: the new version was there afterwards, else the old one
  int while_opening = 0;  // kills before the store was open
};

// Works in `folder`, which is empty. After each kill the store is opened, and every version of every item compared.
KillingCounts kill_at_random(const std::filesystem::path& folder, const KillingPlan& plan);

}  // namespace beltpick::test
