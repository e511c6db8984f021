#include "emulator/live_line.hpp"

#include <chrono>

namespace emulator {

namespace {
using Clock = std::chrono::steady_clock;
constexpr std::chrono::microseconds kSlice(500);
constexpr std::chrono::milliseconds kMostToCatchUp(20);
}  // namespace

LiveLine::LiveLine(Chip& chip) : chip_(chip) {
  thread_ = std::thread([this] { run(); });
}

LiveLine::~LiveLine() {
  stopping_ = true;
  thread_.join();
}

void LiveLine::run() {
  Clock::time_point due = Clock::now();
  while (!stopping_) {
    {
      const std::lock_guard lock(mutex_);
      chip_.run_us(kSlice.count());
      pump();
    }
    due += kSlice;
    const Clock::time_point now = Clock::now();
    if (now - due > kMostToCatchUp) due = now;
    std::this_thread::sleep_until(due);
  }
}

void LiveLine::pump() {
  const std::vector<std::uint8_t> sent = chip_.received();
  terminal_.write(sent.data(), sent.size());
  std::uint8_t bytes[256];
  const std::size_t count = terminal_.read(bytes, sizeof bytes);
  if (count > 0) chip_.send({bytes, bytes + count});
}

}  // namespace emulator
