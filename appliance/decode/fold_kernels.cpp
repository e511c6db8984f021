#include "decode/fold_kernels.hpp"

#include <algorithm>
#include <limits>

#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

// The rounded product of vector units, in the form in which the compiler knows it: both factors 16-bit and in memory.
BELTPICK_INLINE std::int16_t scaled_term(std::int16_t level_q7, std::int16_t weight_q15) {
  return static_cast<std::int16_t>((((level_q7 * weight_q15) >> 14) + 1) >> 1);
}

constexpr int kBlock = 64;
using Block = std::int16_t[kBlock];

// A block of pixels of 8 bits; the weights stand once for each pixel.
template <int kCount, bool kFirst>
BELTPICK_INLINE void accumulate_block(const std::array<const std::uint8_t*, kMaxTogether>& levels, int first, int count,
                                      const Block (&wc)[kMaxTogether], const Block (&ws)[kMaxTogether],
                                      std::int16_t* __restrict cosine, std::int16_t* __restrict sine) {
  alignas(64) Block level_q7[kCount];
  for (std::size_t n = 0; n < kCount; ++n) {
    const std::uint8_t* from = levels[n] + first;
    for (int i = 0; i < count; ++i) level_q7[n][i] = static_cast<std::int16_t>(from[i] << 7);
  }
  for (int i = 0; i < count; ++i) {
    std::int16_t c = kFirst ? std::int16_t{0} : cosine[first + i];
    std::int16_t s = kFirst ? std::int16_t{0} : sine[first + i];
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kCount; ++n) {
      c = static_cast<std::int16_t>(c + scaled_term(level_q7[n][i], wc[n][i]));
      s = static_cast<std::int16_t>(s + scaled_term(level_q7[n][i], ws[n][i]));
    }
    cosine[first + i] = c;
    sine[first + i] = s;
  }
}

template <int kCount, bool kFirst>
BELTPICK_INLINE void accumulate(const FringeRows<std::uint8_t>& rows, int count, std::int16_t* __restrict cosine,
                                std::int16_t* __restrict sine) {
  alignas(64) Block wc[kMaxTogether];
  alignas(64) Block ws[kMaxTogether];
  for (std::size_t n = 0; n < kCount; ++n) {
    for (int i = 0; i < kBlock; ++i) {
      wc[n][i] = rows.cosine_weight_q15[n];
      ws[n][i] = rows.sine_weight_q15[n];
    }
  }
  int first = 0;
  for (; first + kBlock <= count; first += kBlock) {
    accumulate_block<kCount, kFirst>(rows.levels, first, kBlock, wc, ws, cosine, sine);
  }
  accumulate_block<kCount, kFirst>(rows.levels, first, count - first, wc, ws, cosine, sine);
}

// Without fused operations and frame by frame, so that all vector units and all groupings round alike.
template <int kCount, bool kFirst>
BELTPICK_INLINE void accumulate(const FringeRows<std::uint16_t>& rows, int count, float* __restrict cosine,
                                float* __restrict sine) {
  const auto wc = rows.cosine_weight;
  const auto ws = rows.sine_weight;
  const auto levels = rows.levels;
  for (int i = 0; i < count; ++i) {
    float c = kFirst ? 0.0F : cosine[i];
    float s = kFirst ? 0.0F : sine[i];
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kCount; ++n) {
      const auto level = static_cast<float>(levels[n][i]);
      c += wc[n] * level;
      s += ws[n] * level;
    }
    cosine[i] = c;
    sine[i] = s;
  }
}

template <int kCount, class Pixel, class Mean>
BELTPICK_INLINE void accumulate_mean(const FringeRows<Pixel>& rows, int count, Mean* __restrict mean) {
  const auto levels = rows.levels;
  if (rows.first) {
    for (int i = 0; i < count; ++i) mean[i] = static_cast<Mean>(levels[0][i]);
  } else {
    for (int i = 0; i < count; ++i) mean[i] = static_cast<Mean>(mean[i] + levels[0][i]);
  }
  if constexpr (kCount > 1) {
    for (int i = 0; i < count; ++i) {
      Mean m = mean[i];
#pragma GCC unroll 4
      for (std::size_t n = 1; n < kCount; ++n) m = static_cast<Mean>(m + levels[n][i]);
      mean[i] = m;
    }
  }
}

template <int kCount, class Pixel>
BELTPICK_INLINE void flag_saturation(const FringeRows<Pixel>& rows, int count, std::uint8_t* __restrict flags) {
  const auto limit = static_cast<Pixel>(std::min<int>(rows.full_scale, std::numeric_limits<Pixel>::max()));
  const auto levels = rows.levels;
  const std::uint8_t bit = rows.saturation_bit;
  const std::uint8_t keep = rows.first_flags ? 0 : 0xFF;
  for (int i = 0; i < count; ++i) {
    Pixel most = levels[0][i];
#pragma GCC unroll 4
    for (std::size_t n = 1; n < kCount; ++n) most = std::max(most, levels[n][i]);
    flags[i] = static_cast<std::uint8_t>((flags[i] & keep) | (most >= limit ? bit : 0));
  }
}

template <int kCount, class Pixel, class Sum, class Mean>
BELTPICK_INLINE void fold_together(const FringeRows<Pixel>& rows, int count, Sum* cosine, Sum* sine, Mean* mean,
                                   std::uint8_t* flags) {
  if (rows.first) {
    accumulate<kCount, true>(rows, count, cosine, sine);
  } else {
    accumulate<kCount, false>(rows, count, cosine, sine);
  }
  if (mean != nullptr) accumulate_mean<kCount>(rows, count, mean);
  flag_saturation<kCount>(rows, count, flags);
}

template <class Pixel, class Sum, class Mean>
BELTPICK_INLINE void fold_fringe(const FringeRows<Pixel>& rows, int count, Sum* cosine, Sum* sine, Mean* mean,
                                 std::uint8_t* flags) {
  static_assert(kMaxTogether == 4);
  switch (rows.count) {
    case 1:
      fold_together<1>(rows, count, cosine, sine, mean, flags);
      return;
    case 2:
      fold_together<2>(rows, count, cosine, sine, mean, flags);
      return;
    case 3:
      fold_together<3>(rows, count, cosine, sine, mean, flags);
      return;
    default:
      fold_together<4>(rows, count, cosine, sine, mean, flags);
  }
}

}  // namespace

BELTPICK_KERNEL
void accumulate_row(const FringeRows<std::uint8_t>& rows, int count, std::int16_t* cosine, std::int16_t* sine,
                    std::uint16_t* mean, std::uint8_t* flags) {
  fold_fringe(rows, count, cosine, sine, mean, flags);
}
BELTPICK_KERNEL
void accumulate_row(const FringeRows<std::uint16_t>& rows, int count, float* cosine, float* sine, float* mean,
                    std::uint8_t* flags) {
  fold_fringe(rows, count, cosine, sine, mean, flags);
}

}  // namespace beltpick::decode
