#include "virtual_cell/world/wire.hpp"

#include "base/clock.hpp"

namespace beltpick::virtual_cell {

void Wire::drive(bool level, std::int64_t at_us) {
  const std::scoped_lock lock(mutex_);
  const bool rises = level && !near_;
  near_ = level;
  const bool lost = rises && pulses_to_lost_ == 0;
  if (rises && pulses_to_lost_ >= 0) --pulses_to_lost_;
  if (lost) return;  // and its fall finds the far end low already
  if (stuck_at_ && level != *stuck_at_) return;
  pass(level, at_us);
}

void Wire::pass(bool level, std::int64_t at_us) {
  if (level == far_) return;
  far_ = level;
  far_end_(level, at_us);
}

void Wire::stick_at(bool level) {
  const std::scoped_lock lock(mutex_);
  stuck_at_ = level;
}

void Wire::lose_pulse(int further) {
  const std::scoped_lock lock(mutex_);
  pulses_to_lost_ = further;
}

void Wire::mend() {
  const std::scoped_lock lock(mutex_);
  stuck_at_.reset();
  pulses_to_lost_ = -1;
  pass(near_, monotonic_us());
}

}  // namespace beltpick::virtual_cell
