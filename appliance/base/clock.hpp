// Monotonic time in microseconds since an arbitrary start.
#pragma once

#include <chrono>
#include <cstdint>

namespace beltpick {

inline std::int64_t monotonic_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// Measures a stretch of time.
class Stopwatch {
 public:
  [[nodiscard]] double elapsed_ms() const { return static_cast<double>(monotonic_us() - start_us_) / 1000.0; }

 private:
  std::int64_t start_us_ = monotonic_us();
};

}  // namespace beltpick
