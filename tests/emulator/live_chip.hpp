// LiveChip: a chip in real time, its serial line on a pseudo-terminal that any program opens as it would the real one.
// Its cycles follow the wall clock, and stand still for as long as the PC was late: they never hurry to catch up, so
// that no edge comes closer to the one before than the firmware put it.
#pragma once

#include <chrono>
#include <string>

#include "emulator/chip.hpp"
#include "host/line_noise.hpp"
#include "host/pseudo_terminal.hpp"

namespace emulator {

class LiveChip {
 public:
  // The longest wait between two turns.
  static constexpr std::chrono::milliseconds kStep{1};

  // `link`: where a link to the tty is made, empty for none. Throws std::system_error without a pseudo-terminal.
  LiveChip(Chip& chip, const std::string& link);

  [[nodiscard]] const std::string& tty() const { return terminal_.tty(); }
  // The serial line's end, for poll(): a byte on it is a reason for a turn.
  [[nodiscard]] int line_fd() const { return terminal_.fd(); }

  // Runs the chip up to now and moves what its serial line carries.
  void turn();

  // How many bytes have gone over the line so far, both ways.
  [[nodiscard]] std::uint64_t bytes_moved() const { return bytes_moved_; }

  // Damages this share of the bytes, each way.
  void set_noise(double share);
  // Cuts the serial line, or mends it.
  void mute(bool muted) { muted_ = muted; }

 private:
  using Clock = std::chrono::steady_clock;

  void pump();

  Chip& chip_;
  beltpick::host::PseudoTerminal terminal_;
  beltpick::host::LineNoise noise_in_{1};
  beltpick::host::LineNoise noise_out_{2};
  bool muted_ = false;
  std::uint64_t bytes_moved_ = 0;
  Clock::time_point base_;  // when the chip's clock showed base_cycle_
  std::uint64_t base_cycle_;
};

}  // namespace emulator
