// Lanes: a block of pixels as one vector, for kernels that the compiler would cut up otherwise. On units narrower than
// a block it takes several of them, with the same results. Internal to range's kernels.
#pragma once

#include "range/curve_kernel.hpp"

namespace beltpick::range {

using Lanes = float __attribute__((vector_size(kBlock * sizeof(float))));
// The same anywhere in memory.
using LooseLanes = float __attribute__((vector_size(kBlock * sizeof(float)), aligned(4), may_alias));

[[gnu::always_inline]] inline const LooseLanes* loose(const float* at) {
  return reinterpret_cast<const LooseLanes*>(at);
}
[[gnu::always_inline]] inline LooseLanes* loose(float* at) { return reinterpret_cast<LooseLanes*>(at); }

static_assert(kBlock == 16);
inline constexpr Lanes kPixel = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

}  // namespace beltpick::range
