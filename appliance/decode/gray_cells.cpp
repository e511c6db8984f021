#include "decode/gray_cells.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "base/kernel.hpp"

namespace beltpick::decode {
namespace {

#define BELTPICK_INLINE [[gnu::always_inline]] inline

constexpr std::size_t kWords = 32;  // 64-bit words of a row that are taken at a time: 2048 pixels
constexpr std::size_t kBytes = 8 * kWords;
using Rows8 = std::uint64_t[8][kWords];
using Rows16 = std::uint64_t[kMaxGrayBits][kWords];

// Bit b of byte s of the result is bit s of byte b: of every byte position of eight words at once.
BELTPICK_INLINE void exchange(std::uint64_t& a, std::uint64_t& b, int shift, std::uint64_t mask) {
  const std::uint64_t differ = ((a >> shift) ^ b) & mask;
  b ^= differ;
  a ^= differ << shift;
}

BELTPICK_INLINE void transpose(std::uint64_t (&rows)[8]) {
  constexpr std::uint64_t kNibbles = 0x0F0F0F0F0F0F0F0F;
  constexpr std::uint64_t kPairs = 0x3333333333333333;
  constexpr std::uint64_t kSingles = 0x5555555555555555;
#pragma GCC unroll 8
  for (int i = 0; i < 4; ++i) exchange(rows[i], rows[i + 4], 4, kNibbles);
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    if ((i & 2) == 0) exchange(rows[i], rows[i + 2], 2, kPairs);
  }
#pragma GCC unroll 8
  for (int i = 0; i < 8; i += 2) exchange(rows[i], rows[i + 1], 1, kSingles);
}

// Bit rows to a byte a pixel: of the cell (low and high byte) and of its weak bits.
template <int kBits>
BELTPICK_INLINE void spread(const Rows16& code, const Rows16& weak, std::size_t words, Rows8& low, Rows8& high,
                            Rows8& weak_out) {
  for (std::size_t k = 0; k < words; ++k) {
    std::uint64_t cell[16] = {};
    std::uint64_t above = 0;
#pragma GCC unroll 16
    for (int b = kBits - 1; b >= 0; --b) cell[b] = above ^= code[b][k];
    std::uint64_t zeros = ~std::uint64_t{0};  // all lower bits are 0: the next 1 changes at the left border
    std::uint64_t ones = ~std::uint64_t{0};   // all lower bits are 1: the next 0 changes at the right border
    std::uint64_t flags[8] = {};
#pragma GCC unroll 16
    for (int b = 0; b < kBits; ++b) {
      const std::uint64_t at_left = cell[b] & zeros;
      const std::uint64_t at_right = ~cell[b] & ones;
      flags[0] |= weak[b][k] & ~(at_left | at_right);
      flags[1] |= weak[b][k] & at_left;
      flags[2] |= weak[b][k] & at_right;
      zeros &= ~cell[b];
      ones &= cell[b];
    }
    std::uint64_t bytes[8];
#pragma GCC unroll 8
    for (int b = 0; b < 8; ++b) bytes[b] = cell[b];
    transpose(bytes);
    transpose(flags);
#pragma GCC unroll 8
    for (int s = 0; s < 8; ++s) {
      low[s][k] = bytes[s];
      weak_out[s][k] = flags[s];
    }
    if constexpr (kBits > 8) {
#pragma GCC unroll 8
      for (int b = 0; b < 8; ++b) bytes[b] = cell[8 + b];
      transpose(bytes);
#pragma GCC unroll 8
      for (int s = 0; s < 8; ++s) high[s][k] = bytes[s];
    }
  }
}

struct Block {
  Rows16 code, weak;  // in
  Rows8 low, high, weak_out;
};

using BitRows = std::array<const std::uint8_t*, kMaxGrayBits>;

// Bytes `first` on of the rows, by whole words: up to seven bytes beyond a row are read and never used.
BELTPICK_INLINE void take_rows(const BitRows& bit_rows, int bits, int filled, std::size_t width, std::size_t first,
                               std::size_t words, Block& block) {
  for (int b = 0; b < bits; ++b) {
    const std::uint8_t* __restrict from = bit_rows[static_cast<std::size_t>(b)] + first;
    for (std::size_t k = 0; k < words; ++k) std::memcpy(&block.code[b][k], from + 8 * k, 8);
    for (std::size_t k = 0; k < words; ++k) std::memcpy(&block.weak[b][k], from + width + 8 * k, 8);
  }
  for (int b = bits; b < filled; ++b) {
    for (std::size_t k = 0; k < words; ++k) block.code[b][k] = block.weak[b][k] = 0;
  }
}

// The pixels whose bits lay at place s of each byte.
BELTPICK_INLINE void take_pixels(const Block& block, std::size_t s, bool wide, std::size_t count,
                                 std::uint16_t* __restrict cell, std::uint8_t* __restrict weak) {
  const auto* low = reinterpret_cast<const std::uint8_t*>(block.low[s]);
  const auto* high = reinterpret_cast<const std::uint8_t*>(block.high[s]);
  const auto* flags = reinterpret_cast<const std::uint8_t*>(block.weak_out[s]);
  for (std::size_t i = 0; i < count; ++i) weak[i] = flags[i];
  if (wide) {
    for (std::size_t i = 0; i < count; ++i) cell[i] = static_cast<std::uint16_t>(low[i] | high[i] << 8);
  } else {
    for (std::size_t i = 0; i < count; ++i) cell[i] = low[i];
  }
}

template <int kBits>
BELTPICK_INLINE void cells(const BitRows& bit_rows, int bits, std::size_t count, std::uint16_t* cell,
                           std::uint8_t* weak) {
  const std::size_t width = (count + 7) / 8;  // see bit_row_bytes()
  alignas(64) Block block;
  for (std::size_t first = 0; first < width; first += kBytes) {
    const std::size_t bytes = std::min(kBytes, width - first);
    const std::size_t words = (bytes + 7) / 8;
    take_rows(bit_rows, bits, kBits, width, first, words, block);
    spread<kBits>(block.code, block.weak, words, block.low, block.high, block.weak_out);
    for (std::size_t s = 0; s < 8 && s * width + first < count; ++s) {
      const std::size_t at = s * width + first;
      take_pixels(block, s, kBits > 8, std::min(bytes, count - at), cell + at, weak + at);
    }
  }
}

}  // namespace

BELTPICK_KERNEL
void cells_row(const std::array<const std::uint8_t*, kMaxGrayBits>& bit_rows, int bits, int count, std::uint16_t* cell,
               std::uint8_t* weak) {
  if (bits <= 8) {
    cells<8>(bit_rows, bits, static_cast<std::size_t>(count), cell, weak);
  } else {
    cells<kMaxGrayBits>(bit_rows, bits, static_cast<std::size_t>(count), cell, weak);
  }
}

}  // namespace beltpick::decode
