#include "app/log.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <utility>

#include "contract/result_codes.hpp"

namespace beltpick::app {

namespace {

const char* level_name(LogLevel level) {
  switch (level) {
    case LogLevel::kInfo:
      return "info";
    case LogLevel::kWarning:
      return "warn";
    case LogLevel::kFault:
      return "FAULT";
  }
  return "";
}

void write_all(int fd, const char* text, std::size_t bytes) {
  while (bytes > 0) {
    const ssize_t written = ::write(fd, text, bytes);
    if (written <= 0) return;  // nobody reads the log: nothing to be done about it
    text += written;
    bytes -= static_cast<std::size_t>(written);
  }
}

}  // namespace

void Log::write(LogLevel level, const char* format, ...) {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const std::lock_guard lock(mutex_);
  if (count_ == kLines) {
    ++lost_;
    return;
  }
  Line& line = lines_[(first_ + count_++) % kLines];
  line.wall_us = std::chrono::duration_cast<std::chrono::microseconds>(wall).count();
  line.level = level;
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line.text.data(), line.text.size(), format, arguments);
  va_end(arguments);
}

void Log::code(LogLevel level, const char* what, ResultCode code) {
  const auto number = static_cast<unsigned>(code);
  const ResultCodeEntry* entry = find_result_code(code);
  if (entry == nullptr) return write(level, "%s: %u %s", what, number, result_code_name(code).data());
  write(level, "%s: %u %s: %s%s%s", what, number, entry->name.data(), entry->cause.data(),
        entry->remedy.empty() ? "" : "; ", entry->remedy.data());
}

bool Log::take(Line& line, unsigned& lost) {
  const std::lock_guard lock(mutex_);
  lost = std::exchange(lost_, 0U);
  if (count_ == 0) return false;
  line = lines_[first_];
  first_ = (first_ + 1) % kLines;
  --count_;
  return true;
}

void Log::drain(int fd) {
  Line line;
  unsigned lost = 0;
  std::array<char, sizeof line.text + 64> out;
  while (take(line, lost)) {
    const std::time_t seconds = line.wall_us / 1'000'000;
    std::tm broken{};
    gmtime_r(&seconds, &broken);
    const int bytes =
        std::snprintf(out.data(), out.size(), "%04d-%02d-%02d %02d:%02d:%02d.%03d %-5s %s\n", broken.tm_year + 1900,
                      broken.tm_mon + 1, broken.tm_mday, broken.tm_hour, broken.tm_min, broken.tm_sec,
                      static_cast<int>(line.wall_us / 1000 % 1000), level_name(line.level), line.text.data());
    write_all(fd, out.data(), std::min<std::size_t>(static_cast<std::size_t>(bytes), out.size() - 1));
    if (lost > 0) write(LogLevel::kWarning, "%u log lines were lost: too many at once", lost);
  }
}

}  // namespace beltpick::app
