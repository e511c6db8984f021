#include "app/watchdog.hpp"

#include <cstdlib>

namespace beltpick::app {

Watchdog::Beat& Watchdog::add(const char* name, std::int64_t limit_ms, std::int64_t now_us) {
  if (count_ == kMaxThreads) std::abort();  // a thread more than declared is a bug
  Beat& beat = beats_[count_++];
  beat.name_ = name;
  beat.limit_us_ = limit_ms * 1000;
  beat(now_us);
  return beat;
}

const char* Watchdog::hung(std::int64_t now_us) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (now_us - beats_[i].last_us_.load(std::memory_order_relaxed) > beats_[i].limit_us_) return beats_[i].name_;
  }
  return nullptr;
}

}  // namespace beltpick::app
