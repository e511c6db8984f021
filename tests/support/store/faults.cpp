#include "support/store/faults.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>
#include <stdexcept>
#include <utility>

#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"
#include "support/store/disk_script.hpp"
#include "support/store/power_cut.hpp"

namespace beltpick::test {
namespace {

namespace fs = std::filesystem;

const service::ItemId kItem{ItemKind::kTemplate, "knuckle"};

Result<service::Store> open_store(const fs::path& folder) {
  std::vector<std::string> warnings;
  return service::Store::open(folder, warnings, DisturbedStep::kKeep);
}

Result<service::VersionInfo> do_step(service::Store& store, const ExpectedVersion& step) {
  return step.removed ? store.remove(kItem, "t") : store.put(kItem, step.bytes, "t");
}

// The store's folder as it is before the step.
DiskImage image_before(const fs::path& folder, const DisturbedStep& step) {
  fs::remove_all(folder);
  {
    Result<service::Store> store = open_store(folder);
    for (const ExpectedVersion& version : step.before) (void)do_step(*store, version);
  }
  return image_of(folder);
}

// The step in a process of its own, which need not survive; true: it did, and the step was acknowledged.
bool step_apart(const fs::path& folder, const DisturbedStep& step, const std::function<void()>& prepare) {
  const pid_t child = fork();
  if (child == 0) {
    Result<service::Store> store = open_store(folder);
    prepare();
    _exit(store && do_step(*store, step.next) ? 0 : 1);
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("no child process");
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

ExpectedItem expected_of(const DisturbedStep& step, bool acknowledged) {
  ExpectedItem item{kItem, step.before, {}};
  if (acknowledged) {
    item.acknowledged.push_back(step.next);
  } else {
    item.in_flight = step.next;
  }
  return item;
}

void count(FaultCounts& counts, const Comparison& found, bool acknowledged, const std::string& where) {
  ++counts.cases;
  if (found.in_flight_came || acknowledged) ++counts.came_new;
  if (!found.trouble.empty() && counts.trouble.empty()) counts.trouble = where + ": " + found.trouble;
}

void kill_and_compare(const fs::path& folder, const DiskImage& before, const DisturbedStep& step,
                      const DiskScript& script, FaultCounts& counts) {
  write_image(before, folder);
  const bool acknowledged = step_apart(folder, step, [&] { start_disk_script(script); });
  count(counts, compare(folder, expected_of(step, acknowledged), DisturbedStep::kKeep), acknowledged,
        step.name + ", killed at call " + std::to_string(script.at) + ", byte " + std::to_string(script.torn_bytes));
}

// The calls of the undisturbed step.
std::vector<DiskCall> calls_of(const fs::path& folder, const DiskImage& before, const DisturbedStep& step) {
  write_image(before, folder);
  Result<service::Store> store = open_store(folder);
  start_disk_script({});
  const auto done = do_step(*store, step.next);
  std::vector<DiskCall> calls = stop_disk_script();
  if (!done) throw std::runtime_error("the undisturbed step failed");
  return calls;
}

// The same, with the calls of opening the store.
std::vector<DiskCall> calls_from_opening(const fs::path& folder, const DiskImage& before, const DisturbedStep& step) {
  write_image(before, folder);
  start_disk_script({});
  Result<service::Store> store = open_store(folder);
  const bool done = store && do_step(*store, step.next);
  std::vector<DiskCall> calls = stop_disk_script();
  if (!done) throw std::runtime_error("the undisturbed step failed");
  return calls;
}

DiskImage random_power_cut(const DiskImage& before, const fs::path& folder, const std::vector<DiskCall>& calls,
                           std::size_t done, std::mt19937& random) {
  DiskImage chosen;
  std::size_t seen = 0;
  each_power_cut(before, folder, calls, done, 1, [&](const DiskImage& image) {
    if (random() % ++seen == 0) chosen = image;
  });
  return chosen;
}

// The step in this process, disturbed, and what is not as it must be in the store after that.
std::string fail_step(service::Store& store, const DisturbedStep& step, const DiskScript& script, bool& acknowledged) {
  start_disk_script(script);
  const Result<service::VersionInfo> disturbed = do_step(store, step.next);
  (void)stop_disk_script();
  acknowledged = disturbed.has_value();
  const Comparison after = compare(store, expected_of(step, acknowledged), DisturbedStep::kKeep);
  if (!after.trouble.empty()) return after.trouble;
  if (after.in_flight_came) return "refused, but there";
  const ResultCode expected = contract_io::write_error_code(script.error);
  if (!acknowledged && disturbed.error().code != expected) return "not " + std::string(result_code_name(expected));
  return "";
}

// The step disturbed, then, where it was refused, undisturbed.
std::string fail_and_repeat(const fs::path& folder, const DisturbedStep& step, const DiskScript& script) {
  Result<service::Store> store = open_store(folder);
  bool acknowledged = false;
  if (std::string trouble = fail_step(*store, step, script, acknowledged); !trouble.empty()) return trouble;
  if (acknowledged) return "";
  if (const auto again = do_step(*store, step.next); !again) return "not taken when the disk works again";
  return compare(*store, expected_of(step, true), DisturbedStep::kKeep).trouble;
}

void fail_and_compare(const fs::path& folder, const DiskImage& before, const DisturbedStep& step,
                      const DiskScript& script, FaultCounts& counts) {
  const std::string where =
      step.name + ", call " + std::to_string(script.at) + " failing with " + std::to_string(script.error);
  write_image(before, folder);
  Comparison found{fail_and_repeat(folder, step, script), false};
  if (found.trouble.empty()) found = compare(folder, expected_of(step, true), DisturbedStep::kKeep);
  count(counts, found, true, where);

  write_image(before, folder);
  bool acknowledged = false;
  {
    Result<service::Store> store = open_store(folder);
    found.trouble = fail_step(*store, step, script, acknowledged);
  }
  if (found.trouble.empty()) found = compare(folder, expected_of(step, acknowledged), DisturbedStep::kKeep);
  // Where the disk fails for good, what was renamed cannot be taken back.
  if (found.in_flight_came && script.event == DiskEvent::kFail) found.trouble = "refused, but there when opened anew";
  count(counts, found, acknowledged, where);
}

// A damaged newest version: those before it, and the number is not given again.
std::string compare_damaged(const fs::path& folder, const DisturbedStep& step) {
  std::vector<std::string> warnings;
  Result<service::Store> store = service::Store::open(folder, warnings, DisturbedStep::kKeep);
  if (!store) return std::string(store.error().text());
  ExpectedItem expected{kItem, step.before, {}};
  if (expected.acknowledged.size() == DisturbedStep::kKeep) expected.acknowledged.erase(expected.acknowledged.begin());
  const Comparison found = compare(*store, expected, DisturbedStep::kKeep);
  if (!found.trouble.empty()) return found.trouble;
  if (warnings.size() != 1) return "expected one warning, found " + std::to_string(warnings.size());
  const auto fallbacks = store->fallbacks();
  if (fallbacks.size() != 1 || fallbacks[0].damaged != step.next.version) return "the damage is not told";
  return "";
}

}  // namespace

std::vector<DisturbedStep> disturbed_steps(std::size_t bytes) {
  std::vector<ExpectedVersion> versions;
  for (std::uint32_t i = 1; i <= 4; ++i) versions.push_back({i, seeded_bytes(i, bytes), false});
  return {{"first version", {}, versions[0]},
          {"second version", {versions[0]}, versions[1]},
          {"version that pushes one out", {versions[0], versions[1], versions[2]}, versions[3]},
          {"removal", {versions[0], versions[1]}, {3, "", true}}};
}

FaultCounts kill_at_every_call(const fs::path& folder, const DisturbedStep& step) {
  FaultCounts counts;
  const DiskImage before = image_before(folder, step);
  const int calls = static_cast<int>(calls_of(folder, before, step).size());
  for (int at = 0; at < calls; ++at) {
    for (const DiskEvent event : {DiskEvent::kDieBefore, DiskEvent::kDieAfter}) {
      kill_and_compare(folder, before, step, {event, at}, counts);
    }
  }
  return counts;
}

FaultCounts kill_at_every_byte(const fs::path& folder, const DisturbedStep& step) {
  FaultCounts counts;
  const DiskImage before = image_before(folder, step);
  const std::vector<DiskCall> calls = calls_of(folder, before, step);
  for (int at = 0; std::cmp_less(at, calls.size()); ++at) {
    for (std::size_t byte = 1; byte <= calls[static_cast<std::size_t>(at)].bytes.size(); ++byte) {
      kill_and_compare(folder, before, step, {DiskEvent::kTear, at, 0, byte}, counts);
    }
  }
  return counts;
}

FaultCounts fail_at_every_call(const fs::path& folder, const DisturbedStep& step) {
  FaultCounts counts;
  const DiskImage before = image_before(folder, step);
  const std::vector<DiskCall> calls = calls_of(folder, before, step);
  for (int at = 0; std::cmp_less(at, calls.size()); ++at) {
    const std::size_t half = calls[static_cast<std::size_t>(at)].bytes.size() / 2;
    for (const int error : {ENOSPC, EIO}) {
      for (const DiskEvent event : {DiskEvent::kFail, DiskEvent::kFailOnward}) {
        fail_and_compare(folder, before, step, {event, at, error}, counts);
        if (half > 0) fail_and_compare(folder, before, step, {event, at, error, half}, counts);
      }
    }
  }
  return counts;
}

FaultCounts limit_at_every_byte(const fs::path& folder, const DisturbedStep& step) {
  FaultCounts counts;
  const DiskImage before = image_before(folder, step);
  std::size_t file_bytes = 0;
  for (const DiskCall& call : calls_of(folder, before, step)) file_bytes += call.bytes.size();
  for (std::size_t bytes = 0; bytes < file_bytes; ++bytes) {
    write_image(before, folder);
    const bool acknowledged = step_apart(folder, step, [bytes] {
      (void)signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{bytes, bytes};
      (void)setrlimit(RLIMIT_FSIZE, &limit);
    });
    Comparison found = compare(folder, expected_of(step, acknowledged), DisturbedStep::kKeep);
    if (acknowledged || found.in_flight_came) found.trouble = "taken though it cannot have been written";
    count(counts, found, false, step.name + ", no more than " + std::to_string(bytes) + " bytes");
  }
  return counts;
}

FaultCounts cut_power_at_every_call(const fs::path& folder, const DisturbedStep& step, std::size_t byte_step) {
  FaultCounts counts;
  const DiskImage before = image_before(folder, step);
  const std::vector<DiskCall> calls = calls_of(folder, before, step);
  const fs::path after = folder.string() + "-after";
  for (std::size_t done = 0; done <= calls.size(); ++done) {
    const bool acknowledged = done == calls.size();
    each_power_cut(before, folder, calls, done, byte_step, [&](const DiskImage& image) {
      write_image(image, after);
      count(counts, compare(after, expected_of(step, acknowledged), DisturbedStep::kKeep), acknowledged,
            step.name + ", power cut after " + std::to_string(done) + " calls");
    });
  }
  fs::remove_all(after);
  return counts;
}

FaultCounts cut_power_again_and_again(const fs::path& folder, int uploads, std::uint32_t seed) {
  std::mt19937 random(seed);
  FaultCounts counts;
  ExpectedItem item{kItem, {}, {}};
  DiskImage image;
  for (int i = 0; i < uploads && counts.trouble.empty(); ++i) {
    const bool known = !item.acknowledged.empty();
    const bool removes = known && !item.acknowledged.back().removed && random() % 8 == 0;
    const DisturbedStep step{
        "upload " + std::to_string(i),
        item.acknowledged,
        {known ? item.acknowledged.back().version + 1 : 1,
         removes ? "" : seeded_bytes(static_cast<std::uint32_t>(random()), 1 + random() % 200), removes}};
    const std::vector<DiskCall> calls = calls_from_opening(folder, image, step);
    const std::size_t done = random() % (calls.size() + 1);
    image = random_power_cut(image, folder, calls, done, random);
    write_image(image, folder);
    const bool acknowledged = done == calls.size();
    const Comparison found = compare(folder, expected_of(step, acknowledged), DisturbedStep::kKeep);
    count(counts, found, acknowledged, step.name + ", power cut after " + std::to_string(done) + " calls");
    if (acknowledged || found.in_flight_came) item.acknowledged.push_back(step.next);
    if (item.acknowledged.size() > DisturbedStep::kKeep + 1) item.acknowledged.erase(item.acknowledged.begin());
  }
  return counts;
}

FaultCounts damage_every_byte(const fs::path& folder, const DisturbedStep& step, std::size_t bit_step) {
  FaultCounts counts;
  (void)calls_of(folder, image_before(folder, step), step);
  DiskImage image = image_of(folder);
  const std::string newest = image.rbegin()->first;
  const std::string whole = image.rbegin()->second;
  const auto damaged = [&](const std::string& bytes, const std::string& where) {
    image[newest] = bytes;
    write_image(image, folder);
    count(counts, {compare_damaged(folder, step), false}, false, step.name + ", " + where);
  };
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    damaged(whole.substr(0, bytes), "cut at byte " + std::to_string(bytes));
  }
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += bit_step) {
    std::string flipped = whole;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ static_cast<char>(1U << bit % 8));
    damaged(flipped, "bit " + std::to_string(bit) + " flipped");
  }
  damaged(whole + '\0', "a byte longer");
  return counts;
}

}  // namespace beltpick::test
