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
constexpr std::size_t kVectorBytes = kBitRowsReadAhead + 1;  // rows are read by whole vectors

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

using BitRows = std::array<const std::uint8_t*, kMaxGrayBits>;

BELTPICK_INLINE std::uint64_t word_at(const std::uint8_t* from) {
  std::uint64_t word = 0;
  std::memcpy(&word, from, sizeof word);
  return word;
}

struct Block {
  Rows8 low, high, weak;
};

// The bit rows of a code, from some byte on.
struct Words {
  BitRows code{}, weak{};
  std::array<std::uint64_t, kMaxGrayBits> mask{};  // all ones; 0 for rows that the code does not have
};

// Words of kBits bit rows to a byte a pixel: of the cell (low and high byte) and of its weak bits.
template <int kBits>
BELTPICK_INLINE void spread(const Words& rows, std::size_t words, Block& block) {
  for (std::size_t k = 0; k < words; ++k) {
    std::uint64_t cell[16] = {};
    std::uint64_t above = 0;
#pragma GCC unroll 16
    for (int b = kBits - 1; b >= 0; --b) cell[b] = above ^= word_at(rows.code[b] + 8 * k) & rows.mask[b];
    std::uint64_t zeros = ~std::uint64_t{0};  // all lower bits are 0: the next 1 changes at the left border
    std::uint64_t ones = ~std::uint64_t{0};   // all lower bits are 1: the next 0 changes at the right border
    std::uint64_t flags[8] = {};
#pragma GCC unroll 16
    for (int b = 0; b < kBits; ++b) {
      const std::uint64_t weak_bits = word_at(rows.weak[b] + 8 * k) & rows.mask[b];
      const std::uint64_t at_left = cell[b] & zeros;
      const std::uint64_t at_right = ~cell[b] & ones;
      flags[0] |= weak_bits & ~(at_left | at_right);
      flags[1] |= weak_bits & at_left;
      flags[2] |= weak_bits & at_right;
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
      block.low[s][k] = bytes[s];
      block.weak[s][k] = flags[s];
    }
    if constexpr (kBits > 8) {
#pragma GCC unroll 8
      for (int b = 0; b < 8; ++b) bytes[b] = cell[8 + b];
      transpose(bytes);
#pragma GCC unroll 8
      for (int s = 0; s < 8; ++s) block.high[s][k] = bytes[s];
    }
  }
}

// The pixels whose bits lay at place s of each byte.
BELTPICK_INLINE void take_pixels(const Block& block, std::size_t s, bool wide, std::size_t count,
                                 std::uint16_t* __restrict cell, std::uint8_t* __restrict weak) {
  const auto* low = reinterpret_cast<const std::uint8_t*>(block.low[s]);
  const auto* high = reinterpret_cast<const std::uint8_t*>(block.high[s]);
  const auto* flags = reinterpret_cast<const std::uint8_t*>(block.weak[s]);
  for (std::size_t i = 0; i < count; ++i) weak[i] = flags[i];
  if (wide) {
    for (std::size_t i = 0; i < count; ++i) cell[i] = static_cast<std::uint16_t>(low[i] | high[i] << 8);
  } else {
    for (std::size_t i = 0; i < count; ++i) cell[i] = low[i];
  }
}

BELTPICK_INLINE Words words_from(const BitRows& bit_rows, int bits, std::size_t width, std::size_t first) {
  Words rows;
  for (std::size_t b = 0; b < kMaxGrayBits; ++b) {
    const bool own = b < static_cast<std::size_t>(bits);
    rows.code[b] = bit_rows[own ? b : 0] + first;
    rows.weak[b] = rows.code[b] + width;
    rows.mask[b] = own ? ~std::uint64_t{0} : 0;
  }
  return rows;
}

template <int kBits>
BELTPICK_INLINE void cells(const BitRows& bit_rows, int bits, std::size_t count, std::uint16_t* cell,
                           std::uint8_t* weak) {
  const std::size_t width = (count + 7) / 8;  // see bit_row_bytes()
  alignas(64) Block block;
  for (std::size_t first = 0; first < width; first += kBytes) {
    const std::size_t bytes = std::min(kBytes, width - first);
    const std::size_t words = (bytes + kVectorBytes - 1) / kVectorBytes * (kVectorBytes / 8);
    spread<kBits>(words_from(bit_rows, bits, width, first), words, block);
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
  const auto pixels = static_cast<std::size_t>(count);
  if (bits <= 8) {
    cells<8>(bit_rows, bits, pixels, cell, weak);
  } else if (bits <= 10) {  // up to 1024 cells
    cells<10>(bit_rows, bits, pixels, cell, weak);
  } else {
    cells<kMaxGrayBits>(bit_rows, bits, pixels, cell, weak);
  }
}

}  // namespace beltpick::decode
