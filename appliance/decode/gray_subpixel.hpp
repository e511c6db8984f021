// Positions within the cells of a Gray code: between the two places of an image row where a cell begins and ends, the
// coordinate runs evenly. Internal to decode.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/stages.hpp"
#include "decode/finish_kernels.hpp"

namespace beltpick::decode {

// Scratch for a row of `count` pixels, in 16-bit numbers: six rows of whole vectors, with margins that are read beyond
// their ends and never used.
inline constexpr int kRunMargin = 64;
constexpr std::size_t row_numbers(int count) {
  return (static_cast<std::size_t>(count) + 63) / 64 * 64 + 2 * std::size_t{kRunMargin};
}
constexpr std::size_t run_scratch_numbers(int count) { return 6 * row_numbers(count); }

// Replaces the cells' centres in x_px, where a run of valid pixels of one cell lies between runs of the cells before
// and after it, of like length: so only within one surface that rises or falls evenly. The result stays in its cell.
// What is at an end of such a surface keeps the centre.
//   Runs of one or two pixels are the rule: every pixel learns its place within its run, and what the run's neighbours
// are, by steps that double their reach until they span the longest run, each over the whole row.
void refine_cells_row(const std::uint16_t* cell, const PixelState* state, int count, const CellRule& rule,
                      std::span<std::uint16_t> scratch, float* x_px);

}  // namespace beltpick::decode
