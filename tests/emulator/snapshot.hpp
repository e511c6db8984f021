// in_snapshot: tries something in a copy of the whole emulator as it stands, so that the next trial begins at the same
// cycle.
#pragma once

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <optional>

namespace emulator {

// Calls `trial` in a forked copy of this process; what it returned, nothing when it threw or crashed. No threads may
// run.
template <class Trial>
std::optional<std::uint64_t> in_snapshot(const Trial& trial) {
  void* shared = ::mmap(nullptr, sizeof(std::uint64_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return std::nullopt;
  auto* result = static_cast<std::uint64_t*>(shared);
  const pid_t copy = ::fork();
  if (copy == 0) {
    try {
      *result = trial();
    } catch (...) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  int status = -1;
  const bool ended = copy > 0 && ::waitpid(copy, &status, 0) == copy && status == 0;
  const std::uint64_t returned = *result;
  ::munmap(shared, sizeof(std::uint64_t));
  return ended ? std::optional(returned) : std::nullopt;
}

}  // namespace emulator
