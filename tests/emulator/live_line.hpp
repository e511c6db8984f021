// LiveLine: lets a chip run in real time in a thread of its own, for a test that talks to it over its serial line.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "emulator/live_chip.hpp"

namespace emulator {

class LiveLine {
 public:
  explicit LiveLine(Chip& chip);
  ~LiveLine();
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

  [[nodiscard]] const std::string& tty() const { return chip_.tty(); }
  // Damages this share of the line's bytes, each way.
  void set_noise(double share) {
    const auto held = hold();
    chip_.set_noise(share);
  }
  // The chip belongs to the thread; this stops it for as long as the lock is held.
  [[nodiscard]] std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }
  // While it is held.
  [[nodiscard]] LiveChip& live() { return chip_; }

 private:
  void run();

  LiveChip chip_;
  std::mutex mutex_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace emulator
