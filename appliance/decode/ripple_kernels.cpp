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

BELTPICK_INLINE RippleSums sums_of_block(const float* turn, const float* amplitude8, const std::uint8_t* flags,
                                         std::uint8_t flag_bits, float least8, int steps) {
  float u[kRippleBlock], v[kRippleBlock], p[kRippleBlock], q[kRippleBlock];
  int unfit = 0;
  for (int i = 0; i < kRippleBlock; ++i) {
    unfit |= (flags[i] & flag_bits) | (amplitude8[i] < least8 ? 1 : 0);
    p[i] = u[i] = sine_of_turns(turn[i] + 0.25F);
    q[i] = v[i] = sine_of_turns(turn[i]);
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

}  // namespace

BELTPICK_KERNEL
void ripple_sums_row(const float* turn, const float* amplitude8, const std::uint8_t* flags, std::uint8_t flag_bits,
                     float least8, int steps, int blocks, RippleSums* sums) {
  for (int b = 0; b < blocks; ++b) {
    const int at = b * kRippleBlock;
    sums[b] = sums_of_block(turn + at, amplitude8 + at, flags + at, flag_bits, least8, steps);
  }
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
