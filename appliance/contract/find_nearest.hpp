// The surface points of a part nearest to some dozens of places at once: the inner loop of search and alignment.
#pragma once

#include <array>
#include <cstdint>

#include "base/point_block.hpp"
#include "contract/part_model.hpp"

namespace beltpick {

// Writes to `nearest` the surface points nearest to the first `count` points of `at_part` (part frame; at most
// PointBlock::kSize): those that PartModel::nearest() gives, by whichever index the model has.
void find_nearest(const PartModel& model, const PointBlock& at_part, int count, PointBlock& nearest);

// The same in three steps: cells and points lie in far memory, and whoever asks for several blocks at once need not
// wait for each. `begin` and `go_on` tell the memory what the next step will read. All three must be given the same
// model and the same points (part frame), at most PointBlock::kSize.
class NearestQuery {
 public:
  void begin(const PartModel& model, const PointBlock& at_part, int count);
  void go_on(const PartModel& model, int count);
  void finish(const PartModel& model, const PointBlock& at_part, int count, PointBlock& nearest) const;

 private:
  alignas(64) std::array<int, PointBlock::kSize> cell_;
  std::array<std::uint16_t, PointBlock::kSize> index_;
};

}  // namespace beltpick
