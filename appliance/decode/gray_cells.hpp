// The bits of a Gray code to cell numbers, for a row of pixels at once. Internal to decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace beltpick::decode {

inline constexpr int kMaxGrayBits = 16;

// So many bytes beyond a row of bits are read, and never used.
inline constexpr std::size_t kBitRowsReadAhead = 63;

// Where a pixel's bits are weak, as seen from its cell: the one bit that changes at a border of the cell may well be.
enum WeakBits : std::uint8_t {
  kWeakFar = 1,    // a bit that changes at neither border: the cell may be any
  kWeakLeft = 2,   // the bit that changes at the left border
  kWeakRight = 4,  // at the right border
};

// `bit_rows`: rows of `bits` Gray bits, least significant first, as bit_kernels.hpp lays them out. Gives the cell that
// the reflected code numbers, and WeakBits, of each of `count` pixels. Up to kBitRowsReadAhead bytes beyond a row are
// read. Works on bits of 64 pixels at a time and only then spreads them over the pixels, which costs a tenth of doing
// the same pixel by pixel.
void cells_row(const std::array<const std::uint8_t*, kMaxGrayBits>& bit_rows, int bits, int count, std::uint16_t* cell,
               std::uint8_t* weak);

}  // namespace beltpick::decode
