#include "capture/frame_ids.hpp"

namespace beltpick::capture {

std::int64_t frames_between(std::uint64_t before, std::uint64_t now) {
  constexpr std::int64_t kCycle = 65535;
  const auto step = static_cast<std::int64_t>(now - before);
  if (before > kCycle || now > kCycle) return step;
  if (step > kCycle / 2) return step - kCycle;
  return step < -kCycle / 2 ? step + kCycle : step;
}

}  // namespace beltpick::capture
