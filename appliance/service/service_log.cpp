#include "service/service_log.hpp"

#include <algorithm>
#include <utility>

#include "contract_io/file_io.hpp"

namespace beltpick::service {

std::string for_log(std::string_view text) {
  std::string line = contract_io::one_line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
  return line;
}

void RefusalLog::write(const std::string& line, std::int64_t now_us) {
  settle(now_us);
  const std::lock_guard lock(mutex_);
  if (written_ == kLines) {
    ++left_out_;
    return;
  }
  ++written_;
  log_(true, line);
}

void RefusalLog::settle(std::int64_t now_us) {
  const std::lock_guard lock(mutex_);
  if (now_us - began_us_ < kWhile_us) return;
  began_us_ = now_us;
  written_ = 0;
  if (left_out_ > 0) {
    log_(true, "service: " + std::to_string(std::exchange(left_out_, 0U)) + " more refusals were not written out");
  }
}

}  // namespace beltpick::service
