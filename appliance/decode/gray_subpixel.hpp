// Positions within the cells of a Gray code: between the two places of an image row where a cell begins and ends, the
// coordinate runs evenly. Internal to decode.
#pragma once

#include <cstdint>

#include "base/stages.hpp"
#include "decode/finish_kernels.hpp"

namespace beltpick::decode {

// Replaces the cells' centres in x_px, where a run of valid pixels of one cell lies between runs of the cells before
// and after it, of like length: so only within one surface that rises or falls evenly. The result stays in its cell.
// What is at an end of such a surface keeps the centre.
void refine_cells_row(const std::uint16_t* cell, const PixelState* state, int count, const CellRule& rule, float* x_px);

}  // namespace beltpick::decode
