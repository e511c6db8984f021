#include "capture/lines/debounce.hpp"

namespace beltpick::capture {

void Debounce::edge(bool active, std::int64_t at_us) {
  advance(at_us);
  if (active == raw_) return;
  raw_ = active;
  since_us_ = at_us;
  if (raw_ == safe_ || hold_us_ == 0) active_ = raw_;
}

void Debounce::advance(std::int64_t now_us) {
  if (raw_ != active_ && now_us - since_us_ >= hold_us_) active_ = raw_;
}

std::optional<std::int64_t> Debounce::due_us() const {
  if (raw_ == active_) return std::nullopt;
  return since_us_ + hold_us_;
}

}  // namespace beltpick::capture
