#include "emulator/live_chip.hpp"

#include <algorithm>

namespace emulator {

namespace {
constexpr std::chrono::milliseconds kMostToCatchUp(5);
constexpr std::uint64_t kStepCycles = 1000 * kCyclesPerUs;
}  // namespace

LiveChip::LiveChip(Chip& chip, const std::string& link)
    : chip_(chip), terminal_(link), base_(Clock::now()), base_cycle_(chip.cycle()) {}

void LiveChip::set_noise(double share) {
  noise_in_.set_share(share);
  noise_out_.set_share(share);
}

void LiveChip::turn() {
  const Clock::time_point now = Clock::now();
  const auto elapsed_us = std::chrono::duration_cast<std::chrono::microseconds>(now - base_).count();
  std::uint64_t until = base_cycle_ + static_cast<std::uint64_t>(elapsed_us) * kCyclesPerUs;
  if (until > chip_.cycle() + kMostToCatchUp / std::chrono::microseconds(1) * kCyclesPerUs) {
    until = chip_.cycle() + kStepCycles;
    base_ = now;
    base_cycle_ = until;
  }
  pump();
  while (chip_.cycle() < until) {
    chip_.run_until(std::min(until, chip_.cycle() + kStepCycles));
    pump();
  }
}

void LiveChip::pump() {
  std::vector<std::uint8_t> sent = chip_.received();
  sent.resize(noise_out_.pass(sent.data(), sent.size()));
  if (!muted_) terminal_.write(sent.data(), sent.size());
  bytes_moved_ += sent.size();
  std::uint8_t bytes[256];
  const std::size_t count = noise_in_.pass(bytes, terminal_.read(bytes, sizeof bytes));
  if (count == 0 || muted_) return;
  bytes_moved_ += count;
  chip_.send({bytes, bytes + count});
}

}  // namespace emulator
