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

// Phase, with the ripple taken off, and amplitude of a channel.
template <class Pixel>
void gather_fringe(const RowContext& context, int channel, std::span<float> turn, std::span<float> amplitude8, int row);

}  // namespace beltpick::decode
