// The pattern shown once more at the end of a sequence: where it looks different from the first time, something moved.
// Internal to decode.
#pragma once

#include <cstdint>

#include "base/stages.hpp"

namespace beltpick::decode {

// first[i] becomes 128 (32768 for 16 bits) plus what `last` has over it, cut to the range.
void subtract_first_row(const std::uint8_t* last, int count, std::uint8_t* first);
void subtract_first_row(const std::uint16_t* last, int count, std::uint16_t* first);

// Valid pixels whose difference, scaled to 8 bits, is beyond the noise of two frames as bright as the texture and the
// flicker of lamps become kMoved, their coordinates NaN. `second_px`: the other axis, or null.
void mark_moved_row(const std::uint8_t* difference, const std::uint8_t* texture, int count, float to_level8,
                    PixelState* state, float* first_px, float* second_px);
void mark_moved_row(const std::uint16_t* difference, const std::uint8_t* texture, int count, float to_level8,
                    PixelState* state, float* first_px, float* second_px);

}  // namespace beltpick::decode
