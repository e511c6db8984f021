#include "host/line_noise.hpp"

namespace beltpick::host {

std::size_t LineNoise::pass(std::uint8_t* bytes, std::size_t count) {
  if (share_ <= 0.0) return count;
  std::uniform_real_distribution<double> uniform;
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool hit = uniform(random_) < share_;
    const bool dropped = hit && random_() % 2 == 0;
    const auto flip = static_cast<std::uint8_t>(hit ? 1U << random_() % 8 : 0U);
    if (!dropped) bytes[left++] = static_cast<std::uint8_t>(bytes[i] ^ flip);
  }
  return left;
}

}  // namespace beltpick::host
