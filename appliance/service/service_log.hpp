// What the service says to the appliance's log, and a bound on how much of it others can make it say.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace beltpick::service {

// Of what a client sent, that which a log can bear: one line of ASCII.
std::string for_log(std::string_view text);

using LogLine = std::function<void(bool warning, const std::string& line)>;

// Refusals are logged, but whoever is refused must not be able to flood the log: so many lines in a while, the others
// are counted. Any thread.
class RefusalLog {
 public:
  static constexpr int kLines = 10;
  static constexpr std::int64_t kWhile_us = 10'000'000;

  explicit RefusalLog(LogLine log) : log_(std::move(log)) {}

  void write(const std::string& line, std::int64_t now_us);
  // Tells how many lines were left out once their while is over; called now and then.
  void settle(std::int64_t now_us);

 private:
  LogLine log_;
  std::mutex mutex_;
  std::int64_t began_us_ = 0;
  int written_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace beltpick::service
