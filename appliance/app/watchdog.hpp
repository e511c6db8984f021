// Watchdog: every thread beats; the supervisor finds the one that has stopped.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace beltpick::app {

class Watchdog {
 public:
  // A thread's place; beat() from that thread at least every `limit_ms`.
  class Beat {
   public:
    void operator()(std::int64_t now_us) { last_us_.store(now_us, std::memory_order_relaxed); }

   private:
    friend class Watchdog;
    const char* name_ = nullptr;
    std::int64_t limit_us_ = 0;
    std::atomic<std::int64_t> last_us_{0};
  };

  // Before the threads start. `name` is a string literal.
  Beat& add(const char* name, std::int64_t limit_ms, std::int64_t now_us);

  // The name of a thread that has not beaten within its limit; null when all do.
  [[nodiscard]] const char* hung(std::int64_t now_us) const;

 private:
  static constexpr std::size_t kMaxThreads = 8;
  std::array<Beat, kMaxThreads> beats_;
  std::size_t count_ = 0;
};

}  // namespace beltpick::app
