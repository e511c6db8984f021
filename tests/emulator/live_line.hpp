// LiveLine: lets a chip run in real time in a thread of its own, its serial line on a pseudo-terminal that any program
// opens as it would the real one. Where the PC is late the chip's time stands still: it never jumps.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "emulator/chip.hpp"
#include "host/pseudo_terminal.hpp"

namespace emulator {

class LiveLine {
 public:
  explicit LiveLine(Chip& chip);
  ~LiveLine();
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

  [[nodiscard]] const std::string& tty() const { return terminal_.tty(); }
  // The chip belongs to the thread; this stops it for as long as the lock is held.
  [[nodiscard]] std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

 private:
  void run();
  void pump();

  Chip& chip_;
  beltpick::host::PseudoTerminal terminal_{""};
  std::mutex mutex_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace emulator
