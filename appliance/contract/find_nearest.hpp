// The surface points of a part nearest to some dozens of places at once: the inner loop of search and alignment.
#pragma once

#include "base/point_block.hpp"
#include "contract/part_model.hpp"

namespace beltpick {

// Writes to `nearest` the surface points nearest to the first `count` points of `at_part` (part frame): those that
// PartModel::nearest() gives, by whichever index the model has.
void find_nearest(const PartModel& model, const PointBlock& at_part, int count, PointBlock& nearest);

}  // namespace beltpick
