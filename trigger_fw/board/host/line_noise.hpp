// LineNoise: what a bad cable does to the bytes of a serial line: it flips a bit of some and swallows others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace beltpick::host {

class LineNoise {
 public:
  explicit LineNoise(std::uint32_t seed) : random_(seed) {}

  // `share` of the bytes is damaged, 0..1.
  void set_share(double share) { share_ = share; }

  // Damages `count` bytes in place; the number that is left.
  std::size_t pass(std::uint8_t* bytes, std::size_t count);

 private:
  std::mt19937 random_;
  double share_ = 0.0;
};

}  // namespace beltpick::host
