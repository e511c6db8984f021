#include "base/arena.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <new>

namespace beltpick {

std::byte* Arena::claim(const char* name, std::size_t bytes) {
  const std::size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  const std::size_t at = used_;
  used_ += rounded;
  check_room(name, bytes);
  note_share(name, rounded);
  return memory_ == nullptr ? nullptr : memory_ + at;
}

std::byte* Arena::claim_scratch(Phase phase, const char* name, std::size_t bytes) {
  const std::size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  std::size_t& scratch = scratch_[static_cast<std::size_t>(phase)];
  const std::size_t used_before = used_bytes();
  scratch += rounded;
  check_room(name, bytes);
  note_share(name, used_bytes() - used_before);
  return memory_ == nullptr ? nullptr : memory_ + (capacity_ - scratch);
}

void Arena::check_room(const char* name, std::size_t bytes) const {
  if (memory_ == nullptr || used_bytes() <= capacity_) return;
  std::fprintf(stderr,
               "beltpick: the memory budget of %zu bytes does not cover '%s' (%zu bytes): a bug in the budget\n",
               capacity_, name, bytes);
  std::abort();
}

void Arena::note_share(const char* name, std::size_t bytes) {
  Share* share = nullptr;
  for (std::size_t i = 0; i < share_count_; ++i) {
    if (std::strcmp(shares_[i].name, name) == 0) share = &shares_[i];
  }
  if (share == nullptr && share_count_ < kMaxShares) {
    share = &shares_[share_count_++];
    *share = {name, 0};
  }
  if (share != nullptr) share->bytes += bytes;
}

ArenaBlock::ArenaBlock(std::size_t bytes) : bytes_(bytes) {
  constexpr std::size_t kHuge = std::size_t{2} << 20;
  void* block = mmap(nullptr, bytes + kHuge, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (block == MAP_FAILED) throw std::bad_alloc();
  // From a boundary of huge pages on, so that a pass over planes walks few page tables, and the processor's prefetching
  // does not stop every 4 KB.
  data_ = static_cast<std::byte*>(block);
  const std::size_t before = (kHuge - reinterpret_cast<std::uintptr_t>(data_) % kHuge) % kHuge;
  if (before > 0) munmap(data_, before);
  data_ += before;
  const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t pages = (bytes + page - 1) / page * page;
  if (kHuge > before) munmap(data_ + pages, kHuge - before);
  madvise(data_, pages, MADV_HUGEPAGE);  // where the system has none, small ones do
  std::memset(data_, 0, bytes);          // touched now: later there is no time for it
}

ArenaBlock::~ArenaBlock() { munmap(data_, bytes_); }

bool ArenaBlock::lock() const { return mlock(data_, bytes_) == 0; }

}  // namespace beltpick
