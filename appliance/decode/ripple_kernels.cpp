#include "decode/ripple_kernels.hpp"

#include <algorithm>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

// Pairwise, so that it takes vector units.
BELTPICK_INLINE float sum_of(float* values) {
  for (int half = kRippleBlock / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) values[i] += values[i + half];
  }
  return values[0];
}

template <class Sum>
BELTPICK_INLINE RippleSums sums_of_block(const Sum* cosine, const Sum* sine, const std::uint8_t* flags,
                                         std::uint8_t flag_bits, float least_squared, int steps) {
  float u[kRippleBlock], v[kRippleBlock], p[kRippleBlock], q[kRippleBlock];
  int unfit = 0;
  for (int i = 0; i < kRippleBlock; ++i) {
    const auto c = static_cast<float>(cosine[i]);
    const auto s = static_cast<float>(sine[i]);
    const float squared = c * c + s * s;
    unfit |= (flags[i] & flag_bits) | (squared < least_squared ? 1 : 0);
    const float scale = 1.0F / std::sqrt(std::max(squared, 1e-12F));
    p[i] = u[i] = c * scale;
    q[i] = v[i] = s * scale;
  }
  RippleSums sums;
  if (unfit != 0) return sums;
  const auto multiply = [&] {  // (p, q) by (u, v)
    for (int i = 0; i < kRippleBlock; ++i) {
      const float real = p[i] * u[i] - q[i] * v[i];
      q[i] = p[i] * v[i] + q[i] * u[i];
      p[i] = real;
    }
  };
  for (int k = 1; k < steps; ++k) multiply();
  std::copy_n(p, kRippleBlock, u);
  std::copy_n(q, kRippleBlock, v);
  sums.count = kRippleBlock;
  for (std::size_t m = 0; m < kRippleOrders; ++m) {
    float scratch[kRippleBlock];
    std::copy_n(p, kRippleBlock, scratch);
    sums.cosine[m] = sum_of(scratch);
    std::copy_n(q, kRippleBlock, scratch);
    sums.sine[m] = sum_of(scratch);
    multiply();
  }
  return sums;
}

template <class Sum>
BELTPICK_INLINE void sums_of_row(const Sum* cosine, const Sum* sine, const std::uint8_t* flags, std::uint8_t flag_bits,
                                 float least, int steps, int blocks, RippleSums* sums) {
  for (int b = 0; b < blocks; ++b) {
    const int at = b * kRippleBlock;
    sums[b] = sums_of_block(cosine + at, sine + at, flags + at, flag_bits, least * least, steps);
  }
}

// sin(2 pi t) by its odd series to the ninth power after folding t into a quarter turn: error below 4e-6.
BELTPICK_INLINE float sine_of_turns(float t) {
  const float whole = t - std::floor(t + 0.5F);
  const float magnitude = std::fabs(whole);
  const float folded = magnitude > 0.25F ? 0.5F - magnitude : magnitude;
  const float q = folded * folded;
  float s = 42.0586939F;
  s = s * q - 76.7058598F;
  s = s * q + 81.6052493F;
  s = s * q - 41.3417022F;
  s = s * q + 6.2831853F;
  s *= folded;
  return whole < 0.0F ? -s : s;
}

}  // namespace

BELTPICK_KERNEL
void ripple_sums_row(const std::int16_t* cosine, const std::int16_t* sine, const std::uint8_t* flags,
                     std::uint8_t flag_bits, float least, int steps, int blocks, RippleSums* sums) {
  sums_of_row(cosine, sine, flags, flag_bits, least, steps, blocks, sums);
}
BELTPICK_KERNEL
void ripple_sums_row(const float* cosine, const float* sine, const std::uint8_t* flags, std::uint8_t flag_bits,
                     float least, int steps, int blocks, RippleSums* sums) {
  sums_of_row(cosine, sine, flags, flag_bits, least, steps, blocks, sums);
}

BELTPICK_KERNEL
void correct_ripple(const std::array<RippleRow, kRippleOrders>& orders, int count, float* turn) {
  const std::array<RippleRow, kRippleOrders> o = orders;
  const float scale = 2.0F / static_cast<float>(std::max(count - 1, 1));
  for (int i = 0; i < count; ++i) {
    const float x = static_cast<float>(i) * scale - 1.0F;
    float correction = 0.0F;
#pragma GCC unroll 3
    for (std::size_t m = 0; m < kRippleOrders; ++m) {
      const float amplitude = std::min(std::max(o[m].a + x * (o[m].b + x * o[m].c), o[m].low), o[m].high);
      correction += amplitude * sine_of_turns(turn[i] * o[m].cycles + o[m].offset_turns);
    }
    turn[i] += correction;
  }
}

}  // namespace beltpick::decode
