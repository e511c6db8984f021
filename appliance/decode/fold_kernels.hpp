// What folding does to one row of pixels of phase frames, for cameras of 8 and of 16 bits; bit_kernels.hpp: of Gray
// frames. Internal to decode.
#pragma once

#include <array>
#include <cstdint>

#include "decode/plan.hpp"

namespace beltpick::decode {

// Frames of one fringe that are added in one go, so that the sums travel to memory and back once for all of them.
template <class Pixel>
struct FringeRows {
  int count = 0;  // 1 .. kMaxTogether
  std::array<const Pixel*, kMaxTogether> levels{};
  std::array<float, kMaxTogether> cosine_weight{}, sine_weight{};
  std::array<std::int16_t, kMaxTogether> cosine_weight_q15{}, sine_weight_q15{};
  bool first = false;        // sets sums and mean instead of adding to them
  bool first_flags = false;  // sets the flags instead of adding to them
  int full_scale = 255;
  std::uint8_t saturation_bit = 1;
};

// Adds phase frames to the sums of their fringe and, where `mean` is not null, to their sum.
//   8 bits: sum += round((level << 7) * weight_q15 / 2^15), rounded term by term; 16 bits: sum += level * weight.
// flags |= saturation_bit where a level has reached full_scale.
void accumulate_row(const FringeRows<std::uint8_t>& rows, int count, std::int16_t* cosine, std::int16_t* sine,
                    std::uint16_t* mean, std::uint8_t* flags);
void accumulate_row(const FringeRows<std::uint16_t>& rows, int count, float* cosine, float* sine, float* mean,
                    std::uint8_t* flags);

}  // namespace beltpick::decode
