#include "decode/witnesses.hpp"

#include <algorithm>

namespace beltpick::decode {
namespace {

constexpr int kEnough = 2500;

}  // namespace

Witnesses::Witnesses(Arena& arena, int probes, int frames)
    : capacity_(static_cast<std::size_t>(std::min(probes, 2 * kEnough) / kBlock + 1) * kBlock) {
  probe_ = arena.take<std::uint32_t>("frame probes", capacity_);
  low8_ = arena.take<float>("frame probes", capacity_);
  high8_ = arena.take<float>("frame probes", capacity_);
  level8_ = arena.take<float>("frame probes", capacity_ * static_cast<std::size_t>(frames));
}

void Witnesses::gather(const FrameProbes& probes, int frames, float to_level8, std::span<const std::uint8_t> lit,
                       std::span<const float> low8, std::span<const float> high8) {
  const int stride = std::max(1, probes.count() / kEnough);
  count_ = 0;
  for (int i = 0; i < probes.count(); i += stride) {
    if (lit[static_cast<std::size_t>(i)] != 0)
      probe_[static_cast<std::size_t>(count_++)] = static_cast<std::uint32_t>(i);
  }
  const auto put = [&](float* out, auto value) {
    for (int w = 0; w < count_; ++w) out[w] = value(probe_[static_cast<std::size_t>(w)]);
    std::fill_n(out + count_, (kBlock - count_ % kBlock) % kBlock, 0.0F);
  };
  put(low8_.data(), [&](std::uint32_t i) { return low8[i]; });
  put(high8_.data(), [&](std::uint32_t i) { return high8[i]; });
  for (int f = 0; f < frames; ++f) {
    const std::span<const std::uint16_t> levels = probes.levels(f);
    put(&level8_[static_cast<std::size_t>(f) * capacity_],
        [&](std::uint32_t i) { return to_level8 * static_cast<float>(levels[i]); });
  }
}

}  // namespace beltpick::decode
