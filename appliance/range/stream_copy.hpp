// Writes past the caches, for results that are larger than they are and will not be read again soon: without it, every
// line written is first read from memory, and drives from the caches what the next rows need. Internal to range.
#pragma once

#include <cstdint>
#include <cstring>

#include "range/lanes.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace beltpick::range {

// Blocks that follow each other in memory, so that whole lines come together, wherever the first begins.
[[gnu::always_inline]] inline void stream_block(const Lanes& block, float* to) {
#if defined(__SSE2__)
  if (reinterpret_cast<std::uintptr_t>(to) % 16 == 0) {
    const auto* from = reinterpret_cast<const float*>(&block);
    for (int i = 0; i < kBlock; i += 4) _mm_stream_ps(to + i, _mm_load_ps(from + i));
    return;
  }
#endif
  std::memcpy(to, &block, sizeof block);
}

// To be called once after the last block, before another thread reads.
inline void stream_end() {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}

}  // namespace beltpick::range
