#include "support/store/killing.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <new>
#include <random>
#include <stdexcept>
#include <vector>

#include "support/store/expected.hpp"

namespace beltpick::test {
namespace {

constexpr std::size_t kMaxUploads = 10'000;  // of one process's life
constexpr int kRemoveEvery = 16;

// One upload, in memory that outlives the process that does it.
struct Upload {
  std::uint32_t item = 0;
  std::uint32_t seed = 0;
  std::size_t bytes = 0;
  bool removes = false;
  std::uint32_t version = 0;
  std::atomic<bool> acknowledged = false;
};

struct Journal {
  std::atomic<bool> open = false;
  std::atomic<std::size_t> begun = 0;
  std::atomic<std::size_t> acknowledged = 0;
  std::atomic<std::uint32_t> last_us = 5000;  // what an upload took
  std::atomic<bool> failed = false;
  std::array<Upload, kMaxUploads> uploads;
};

Journal& shared_journal() {
  void* const memory = mmap(nullptr, sizeof(Journal), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("no shared memory");
  return *new (memory) Journal;
}

std::vector<ExpectedItem> fresh_items() {
  std::vector<ExpectedItem> items;
  for (const service::ItemId& id :
       {service::ItemId{ItemKind::kCalibration, "calibration"}, service::ItemId{ItemKind::kTemplate, "knuckle"},
        service::ItemId{ItemKind::kTemplate, "part-2"}, service::ItemId{ItemKind::kRecipe, "mixed"}}) {
    items.push_back({id, {}, {}});
  }
  return items;
}

// What the next upload is to be; the version number is the one it must get.
void plan_upload(const service::Store& store, const service::ItemId& id, std::mt19937& random, std::size_t max_bytes,
                 Upload& upload) {
  const auto versions = store.versions(id);
  upload.seed = static_cast<std::uint32_t>(random());
  upload.removes = random() % kRemoveEvery == 0 && store.current(id).has_value() && !item_kind(id.kind).single;
  upload.version = versions.empty() ? 1 : versions.back().version + 1;
  // Mostly small, so that the kill meets all steps, not only the writing of bytes.
  upload.bytes = random() % (random() % 4 == 0 ? max_bytes : 2000);
}

// The process that will be killed. Never returns.
void upload_until_killed(const std::filesystem::path& folder, const KillingPlan& plan, std::uint32_t seed,
                         Journal& journal) {
  std::vector<std::string> warnings;
  Result<service::Store> store = service::Store::open(folder, warnings);
  const std::vector<ExpectedItem> items = fresh_items();
  std::mt19937 random(seed);
  journal.failed = !store;
  journal.open = true;
  for (std::size_t i = 0; i < kMaxUploads && !journal.failed; ++i) {
    Upload& upload = journal.uploads[i];
    upload.item = static_cast<std::uint32_t>(random() % items.size());
    const service::ItemId& id = items[upload.item].id;
    plan_upload(*store, id, random, plan.max_bytes, upload);
    const std::string bytes = seeded_bytes(upload.seed, upload.bytes);
    const auto began = std::chrono::steady_clock::now();
    journal.begun = i + 1;
    const auto done = upload.removes ? store->remove(id, "t") : store->put(id, bytes, "t");
    journal.failed = !done || done->version != upload.version;
    upload.acknowledged = !journal.failed;
    journal.acknowledged = i + 1;
    journal.last_us = static_cast<std::uint32_t>((std::chrono::steady_clock::now() - began).count() / 1000);
  }
  for (;;) pause();
}

// One time in eight for a part of the time that opening takes, else for some uploads and a part of one.
void wait_a_while(const Journal& journal, std::mt19937& random) {
  if (random() % 8 == 0) {
    usleep(static_cast<useconds_t>(random() % 3000));
    return;
  }
  const std::size_t uploads = random() % 4;
  while (!journal.failed && (!journal.open || journal.acknowledged < uploads)) usleep(50);
  usleep(static_cast<useconds_t>(random() % (2 * journal.last_us + 1)));
}

// What the life of a process, ended by the kill, adds to what must be there.
void take_over(const Journal& journal, std::vector<ExpectedItem>& items, KillingCounts& counts) {
  const std::size_t begun = journal.begun;
  for (std::size_t i = 0; i < begun; ++i) {
    const Upload& upload = journal.uploads[i];
    ExpectedItem& item = items[upload.item];
    const std::uint32_t version = item.acknowledged.empty() ? 1 : item.acknowledged.back().version + 1;
    ExpectedVersion made{version, upload.removes ? "" : seeded_bytes(upload.seed, upload.bytes), upload.removes};
    ++counts.uploads;
    if (upload.acknowledged) {
      if (upload.version != version) counts.trouble = "a version number was left out or given twice";
      item.acknowledged.push_back(std::move(made));
      ++counts.acknowledged;
    } else {
      item.in_flight = std::move(made);
      ++counts.hit;
    }
    if (item.acknowledged.size() > service::Store::kKeep + 1) item.acknowledged.erase(item.acknowledged.begin());
  }
}

void compare_all(const std::filesystem::path& folder, std::vector<ExpectedItem>& items, KillingCounts& counts) {
  for (ExpectedItem& item : items) {
    const Comparison found = compare(folder, item);
    if (!found.trouble.empty()) counts.trouble = item.id.name + ": " + found.trouble;
    if (found.in_flight_came) {
      item.acknowledged.push_back(*item.in_flight);
      ++counts.came_new;
    }
    item.in_flight.reset();
  }
}

}  // namespace

KillingCounts kill_at_random(const std::filesystem::path& folder, const KillingPlan& plan) {
  Journal& journal = shared_journal();
  KillingCounts counts;
  std::vector<ExpectedItem> items = fresh_items();
  std::mt19937 random(plan.seed);
  while (counts.trouble.empty() && (counts.kills < plan.kills || counts.uploads < plan.uploads)) {
    new (&journal) Journal;
    const auto seed = static_cast<std::uint32_t>(random());
    const pid_t child = fork();
    if (child == 0) upload_until_killed(folder, plan, seed, journal);
    wait_a_while(journal, random);
    (void)kill(child, SIGKILL);
    (void)waitpid(child, nullptr, 0);
    ++counts.kills;
    counts.while_opening += journal.open ? 0 : 1;
    if (journal.failed) counts.trouble = "the store refused an upload";
    take_over(journal, items, counts);
    compare_all(folder, items, counts);
  }
  (void)munmap(&journal, sizeof(Journal));
  return counts;
}

}  // namespace beltpick::test
