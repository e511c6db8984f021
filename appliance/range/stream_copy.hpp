// A copy past the caches, for results that are larger than they are and will not be read again soon: without it, every
// line written is first read from memory, and drives from the caches what the next rows need. Internal to range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace beltpick::range {

inline void stream_copy(const float* from, std::size_t count, float* to) {
#if defined(__SSE2__)
  constexpr std::size_t kLine = 16;  // floats of a cache line
  while (count > 0 && reinterpret_cast<std::uintptr_t>(to) % 64 != 0) {
    *to++ = *from++;
    --count;
  }
  for (; count >= kLine; count -= kLine, from += kLine, to += kLine) {
    for (std::size_t i = 0; i < kLine; i += 4) _mm_stream_ps(to + i, _mm_loadu_ps(from + i));
  }
#endif
  std::memcpy(to, from, count * sizeof(float));
}

// To be called once after the last copy, before another thread reads.
inline void stream_end() {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}

}  // namespace beltpick::range
