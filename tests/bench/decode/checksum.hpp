// Whether two range images hold the same bits.
#pragma once

#include <bit>
#include <cstdint>

#include "base/stages.hpp"

namespace beltpick::bench {

inline unsigned long long checksum(const RangeImage& range) {
  std::uint64_t sum = 1469598103934665603U;
  const auto add = [&](float value) { sum = (sum ^ std::bit_cast<std::uint32_t>(value)) * 1099511628211U; };
  for (std::size_t i = 0; i < range.point_mm.size(); ++i) {
    for (int k = 0; k < 3; ++k) add(range.point_mm.data[i][k]);
    add(range.sigma_mm.data[i]);
  }
  return sum;
}

}  // namespace beltpick::bench
