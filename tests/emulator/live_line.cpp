#include "emulator/live_line.hpp"

namespace emulator {

LiveLine::LiveLine(Chip& chip) : chip_(chip, "") {
  thread_ = std::thread([this] { run(); });
}

LiveLine::~LiveLine() {
  stopping_ = true;
  thread_.join();
}

void LiveLine::run() {
  while (!stopping_) {
    {
      const std::lock_guard lock(mutex_);
      chip_.turn();
    }
    std::this_thread::sleep_for(LiveChip::kStep);
  }
}

}  // namespace emulator
