// Fringe components of a row to phase and amplitude, in their own place. Internal to decode.
#pragma once

#include <cstdint>

namespace beltpick::decode {

// Parts of a turn in the phases of 8-bit cameras: a period of 16 pixels is told to 0.0002 of one.
inline constexpr float kPartsOfTurn = 65536.0F;

// In place of the cosine, atan2(sine, cosine) / 2 pi in [-1/2, 1/2]: for 8 bits in whole parts of a turn (to 0.6 of
// one; half a turn may have either sign), for 16 bits in turns, with an error below 1e-7. In place of the sine,
// |(cosine, sine)|, for 8 bits to 2e-5 of it, and to be read as an unsigned number.
void phase_row(std::int16_t* cosine_to_turn, std::int16_t* sine_to_amplitude, int count);
void phase_row(float* cosine_to_turn, float* sine_to_amplitude, int count);

// What phase_row() left, in turns, and the amplitude times `scale`.
void fringe_row(const std::int16_t* turn, const std::int16_t* amplitude, int count, float scale, float* turn_out,
                float* amplitude8);
void fringe_row(const float* turn, const float* amplitude, int count, float scale, float* turn_out, float* amplitude8);

}  // namespace beltpick::decode
