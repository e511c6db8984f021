// The arithmetic of ripple.hpp on rows of pixels. Internal to decode.
#pragma once

#include <array>
#include <cstdint>

namespace beltpick::decode {

inline constexpr int kRippleOrders = 3;
inline constexpr int kRippleBlock = 32;

// Sums of cos and sin of m N p, m = 1.., over a block of pixels; count 0 where the block is left out.
struct RippleSums {
  int count = 0;
  std::array<float, kRippleOrders> cosine{}, sine{};
};

// For each whole block of kRippleBlock pixels of a row, of the phase p in turns; left out where an amplitude is below
// `least8` or a flag has one of the bits.
void ripple_sums_row(const float* turn, const float* amplitude8, const std::uint8_t* flags, std::uint8_t flag_bits,
                     float least8, int steps, int blocks, RippleSums* sums);

// How one order's correction runs along a row: amplitude = clamp(a + x (b + x c)), x from -1 to 1 over the row.
struct RippleRow {
  float a = 0.0F, b = 0.0F, c = 0.0F;
  float low = 0.0F, high = 0.0F;
  float cycles = 0.0F;  // of the correction in a period: m N
  float offset_turns = 0.0F;
};

// turn += sum of amplitude_m sin(2 pi (cycles_m turn + offset_m)).
void correct_ripple(const std::array<RippleRow, kRippleOrders>& orders, int count, float* turn);

}  // namespace beltpick::decode
