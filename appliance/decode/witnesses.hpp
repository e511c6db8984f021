// Witnesses: the lit ones of every so-many-th probe, their levels scaled to 0..255 and side by side, frame by frame:
// what sums over the image are taken of. Some thousands tell as much as all. Internal to decode.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "decode/frame_probes.hpp"

namespace beltpick::decode {

class Witnesses {
 public:
  static constexpr int kBlock = 64;  // room is for whole blocks; what is beyond the last witness is 0

  Witnesses() = default;
  Witnesses(Arena& arena, int probes, int frames);

  // `lit`, `low8`, `high8`: by probe, over the frames that count.
  void gather(const FrameProbes& probes, int frames, float to_level8, std::span<const std::uint8_t> lit,
              std::span<const float> low8, std::span<const float> high8);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int probe(int w) const { return static_cast<int>(probe_[static_cast<std::size_t>(w)]); }
  [[nodiscard]] const float* low8() const { return low8_.data(); }
  [[nodiscard]] const float* high8() const { return high8_.data(); }
  [[nodiscard]] const float* level8(int frame) const { return &level8_[static_cast<std::size_t>(frame) * capacity_]; }

 private:
  std::size_t capacity_ = 0;
  int count_ = 0;
  std::span<std::uint32_t> probe_;
  std::span<float> low8_, high8_, level8_;
};

// The sum of value(i), i from 0 to count, in lanes that a vector unit adds at a time, and block by block in double
// precision.
template <class Value>
double sum_in_lanes(int count, const Value& value) {
  constexpr int kLanes = 16;
  double sum = 0.0;
  for (int first = 0; first < count; first += Witnesses::kBlock) {
    const int end = std::min(first + Witnesses::kBlock, count);
    std::array<float, kLanes> lanes{};
    int i = first;
    for (; i + kLanes <= end; i += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) lanes[static_cast<std::size_t>(lane)] += value(i + lane);
    }
    for (; i < end; ++i) lanes[0] += value(i);
    for (const float lane : lanes) sum += static_cast<double>(lane);
  }
  return sum;
}

}  // namespace beltpick::decode
