#include "heap_counter.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);
extern "C" void* __libc_memalign(std::size_t, std::size_t);
extern "C" void __libc_free(void*);

namespace {

struct Slot {
  long thread_id = 0;
  std::atomic<long> taken{0};
  std::atomic<long> given_back{0};
};

std::array<Slot, 512> slots;
std::atomic<std::size_t> used_slots{0};
std::atomic<bool> counting{false};
thread_local Slot* mine = nullptr;

Slot& slot() {
  if (mine == nullptr) {
    const std::size_t at = used_slots.fetch_add(1);
    if (at >= slots.size()) std::abort();
    mine = &slots[at];
    mine->thread_id = syscall(SYS_gettid);
  }
  return *mine;
}

void take() {
  if (counting.load(std::memory_order_relaxed)) slot().taken.fetch_add(1, std::memory_order_relaxed);
}

void give_back(const void* block) {
  if (block != nullptr && counting.load(std::memory_order_relaxed)) {
    slot().given_back.fetch_add(1, std::memory_order_relaxed);
  }
}

std::string thread_name(long id) {
  std::ifstream file("/proc/self/task/" + std::to_string(id) + "/comm");
  std::string name;
  return std::getline(file, name) ? name : "ended";
}

}  // namespace

extern "C" void* malloc(std::size_t size) {
  take();
  return __libc_malloc(size);
}
extern "C" void* calloc(std::size_t number, std::size_t size) {
  take();
  return __libc_calloc(number, size);
}
extern "C" void* realloc(void* block, std::size_t size) {
  take();
  give_back(block);
  return __libc_realloc(block, size);
}
extern "C" void* memalign(std::size_t alignment, std::size_t size) {
  take();
  return __libc_memalign(alignment, size);
}
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
extern "C" int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block == nullptr ? 12 : 0;
}
extern "C" void free(void* block) {
  give_back(block);
  __libc_free(block);
}

namespace heap {

void start() {
  for (Slot& each : slots) each.taken = each.given_back = 0;
  counting = true;
}

void stop() { counting = false; }

std::vector<ThreadCount> counts() {
  std::vector<ThreadCount> out;
  const auto of = [&](const std::string& name) -> ThreadCount& {
    const auto at =
        std::find_if(out.begin(), out.end(), [&](const ThreadCount& count) { return count.thread == name; });
    return at != out.end() ? *at : out.emplace_back(ThreadCount{name});
  };
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    of(thread_name(std::stol(task.path().filename())));
  }
  for (std::size_t i = 0; i < used_slots; ++i) {
    ThreadCount& count = of(thread_name(slots[i].thread_id));
    count.taken += slots[i].taken;
    count.given_back += slots[i].given_back;
  }
  return out;
}

}  // namespace heap
