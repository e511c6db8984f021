// Wire: a signal from one device of the cell to another, and what can break on the way: it sticks at a level, or loses
// a pulse. Its far end follows the near end while it is whole.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

namespace beltpick::virtual_cell {

class Wire {
 public:
  // Told each change of the far end, with a time of monotonic_us(), in the thread that makes it.
  using FarEnd = std::function<void(bool level, std::int64_t at_us)>;

  // Both ends are low.
  explicit Wire(FarEnd far_end) : far_end_(std::move(far_end)) {}

  // The device at the near end drives it. From any thread, as what follows.
  void drive(bool level, std::int64_t at_us);

  // From the next time on that it has this level, it stays there.
  void stick_at(bool level);
  // The pulse behind `further` ones does not arrive.
  void lose_pulse(int further);
  // Whole again: the far end takes the level of the near end.
  void mend();

 private:
  void pass(bool level, std::int64_t at_us);

  const FarEnd far_end_;
  std::mutex mutex_;
  bool near_ = false;
  bool far_ = false;
  int pulses_to_lost_ = -1;  // the pulses to come before the one that is lost
  std::optional<bool> stuck_at_;
};

}  // namespace beltpick::virtual_cell
