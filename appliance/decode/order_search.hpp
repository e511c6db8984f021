// The fringe order from several periods at once. Internal to decode.
#pragma once

#include "decode/row_decoder.hpp"

namespace beltpick::decode {

// Of all fringe orders of the finest period (within the Gray cell where there is a code, else over the whole extent)
// takes the one that the other periods' phases fit best: maximum likelihood under phase noise, so hierarchical and
// heterodyne sets of periods are decoded alike. Reads scratch.turn, amplitude8, mean8, cell and weak; writes
// x_px and order_safe (0 where the best order does not fit, or another fits nearly as well).
void order_search_row(const FoldPlan& plan, const AxisPlan& axis, const GrayCode* code, RowScratch& scratch, int cols,
                      float* x_px);

}  // namespace beltpick::decode
