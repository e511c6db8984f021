// Log: lines a person can read, from threads that may not allocate: each line goes into a fixed ring, the supervisor
// writes the ring out.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "base/result.hpp"

namespace beltpick::app {

enum class LogLevel : std::uint8_t { kInfo, kWarning, kFault };

class Log {
 public:
  // One line; longer text is cut. Any thread; neither blocks on output nor allocates. A full ring drops the line and
  // counts it.
  [[gnu::format(printf, 3, 4)]] void write(LogLevel level, const char* format, ...);

  // "<what>: 108 BELT_MOVED_DURING_CAPTURE: cause; remedy".
  void code(LogLevel level, const char* what, ResultCode code);

  // Writes what waits to file descriptor `fd`: "2026-01-31 12:34:56.789 fault  text". One thread.
  void drain(int fd);

 private:
  struct Line {
    std::int64_t wall_us = 0;
    LogLevel level = LogLevel::kInfo;
    std::array<char, 480> text{};
  };
  static constexpr std::size_t kLines = 256;

  bool take(Line& line, unsigned& lost);

  std::mutex mutex_;
  std::array<Line, kLines> lines_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  unsigned lost_ = 0;
};

}  // namespace beltpick::app
