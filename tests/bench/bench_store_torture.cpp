// Whether anything can make the store lose a version, or show half of one:
//   bench_store_torture [UPLOADS] [SEED] [FOLDER]        default: 1000 1 and the folder for temporary files
// At least UPLOADS uploads are begun while kill -9 comes at random, once in FOLDER, on its disk, and ten times as many
// in memory, where other moments are met; UPLOADS uploads end in a power cut each; and single uploads of 700 bytes are
// disturbed in every possible place, as tests/support/store/faults.hpp tells. After each disturbance the store is
// opened anew and every version compared. Prints a table and, as its last line, JSON; the exit code tells whether all
// was as it must be.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "support/store/faults.hpp"
#include "support/store/killing.hpp"
#include "support/temp_folder.hpp"

namespace beltpick::bench {
namespace {

using test::DisturbedStep;
using test::FaultCounts;
using test::KillingCounts;

constexpr std::size_t kItemBytes = 700;

struct Row {
  std::string name;
  int disturbed = 0;
  int came_new = 0;
  std::string trouble;
  std::string more;  // members for the JSON
};

class Report {
 public:
  void add(const Row& row) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - last_).count();
    last_ = std::chrono::steady_clock::now();
    std::printf("%-28s %9d %9d %9d %8.1f  %s\n", row.name.c_str(), row.disturbed, row.came_new,
                row.disturbed - row.came_new, seconds, row.trouble.empty() ? "none" : row.trouble.c_str());
    (void)std::fflush(stdout);
    json_ += (json_.empty() ? "" : ", ") + ("\"" + row.name + "\": {\"disturbed\": " + std::to_string(row.disturbed)) +
             ", \"new\": " + std::to_string(row.came_new) + row.more +
             ", \"violations\": " + (row.trouble.empty() ? "0" : "1") + "}";
    failed_ = failed_ || !row.trouble.empty();
  }
  int finish() const {
    std::printf("{%s}\n", json_.c_str());
    return failed_ ? 1 : 0;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::string json_;
  bool failed_ = false;
};

Row killed_at_random(const std::string& name, const std::filesystem::path& parent, const test::KillingPlan& plan) {
  const test::TempFolder temp(parent);
  const KillingCounts counts = test::kill_at_random(temp / "store", plan);
  const auto member = [](const char* key, int value) {
    return ", \"" + std::string(key) + "\": " + std::to_string(value);
  };
  return {name, counts.hit, counts.came_new, counts.trouble,
          member("kills", counts.kills) + member("while_opening", counts.while_opening) +
              member("uploads", counts.uploads) + member("acknowledged", counts.acknowledged)};
}

Row every_step(const std::string& name,
               const std::function<FaultCounts(const std::filesystem::path&, const DisturbedStep&)>& disturb) {
  Row row{name, 0, 0, "", ""};
  for (const DisturbedStep& step : test::disturbed_steps(kItemBytes)) {
    const test::TempFolder temp(test::memory_folder());
    const FaultCounts counts = disturb(temp / "store", step);
    row.disturbed += counts.cases;
    row.came_new += counts.came_new;
    if (row.trouble.empty()) row.trouble = counts.trouble;
  }
  return row;
}

Row power_cut_at_every_upload(int uploads, std::uint32_t seed) {
  const test::TempFolder temp(test::memory_folder());
  const FaultCounts counts = test::cut_power_again_and_again(temp / "store", uploads, seed);
  return {"power cut at every upload", counts.cases, counts.came_new, counts.trouble, ""};
}

int run(int uploads, std::uint32_t seed, const std::filesystem::path& folder) {
  Report report;
  std::printf("%-28s %9s %9s %9s %8s  %s\n", "what", "disturbed", "then new", "then old", "s", "violations");
  report.add(killed_at_random("kill at random, disk", folder, {.kills = 1, .uploads = uploads, .seed = seed}));
  report.add(killed_at_random("kill at random, memory", test::memory_folder(),
                              {.kills = 1, .uploads = 10 * uploads, .seed = seed}));
  report.add(every_step("kill at every call", test::kill_at_every_call));
  report.add(every_step("kill at every byte", test::kill_at_every_byte));
  report.add(every_step("every call fails", test::fail_at_every_call));
  report.add(every_step("no room after every byte", test::limit_at_every_byte));
  report.add(every_step("power cut, every byte",
                        [](const auto& at, const auto& step) { return test::cut_power_at_every_call(at, step, 1); }));
  report.add(power_cut_at_every_upload(uploads, seed));
  report.add(every_step("newest: every byte, bit",
                        [](const auto& at, const auto& step) { return test::damage_every_byte(at, step, 1); }));
  return report.finish();
}

}  // namespace
}  // namespace beltpick::bench

int main(int argc, char** argv) {
  const int uploads = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int seed = argc > 2 ? std::atoi(argv[2]) : 1;
  if (uploads < 1 || seed < 0 || argc > 4) {
    std::fprintf(stderr, "usage: bench_store_torture [UPLOADS] [SEED] [FOLDER]\n");
    return 2;
  }
  const std::filesystem::path folder = argc > 3 ? argv[3] : std::filesystem::temp_directory_path();
  return beltpick::bench::run(uploads, static_cast<std::uint32_t>(seed), folder);
}
