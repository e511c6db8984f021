// What finishing a row reads of a plan's state. Internal to decode.
#pragma once

#include <span>

#include "decode/row_decoder.hpp"

namespace beltpick::decode {

// Brings the Gray bits of a row together, those resolved on arrival and those that waited: scratch.cell and .weak.
template <class Pixel>
void gather_gray(const RowContext& context, const GrayCode& code, RowScratch& scratch, int row);

// How bright a row is on average and how far white stands above it: scratch.mean8 and .half8.
template <class Pixel>
void gather_levels(const RowContext& context, const Reference& reference, RowScratch& scratch, int row);

// Phase, in turns, and amplitude of a channel, as folding left them.
template <class Pixel>
void gather_phase(const RowContext& context, int channel, std::span<float> turn, std::span<float> amplitude8, int row);
struct Phase {
  float turn, amplitude8;
};
template <class Pixel>
Phase phase_at(const RowContext& context, int channel, int row, int col);

// The same with the ripple taken off the phase.
template <class Pixel>
void gather_fringe(const RowContext& context, int channel, std::span<float> turn, std::span<float> amplitude8, int row);

}  // namespace beltpick::decode
