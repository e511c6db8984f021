// Joins small pieces that stand on or in another object to it: a boss above its plate, the floor of a pocket.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "segment/components.hpp"
#include "segment/pair_table.hpp"

namespace beltpick::segment {

// Steep walls are seen edge on and their shadows are dark, so a depth step parts a boss from the plate it stands on. A
// piece goes to another object where that borders most of its measured outline and is several times as large. A part
// that lies on another of its kind is too large for that.
class Fragments {
 public:
  explicit Fragments(Arena& arena);

  // Gives joined components one number in `components`.
  void join(const RangeImage& range, Components& components);

 private:
  struct Border {
    int pixels = 0;
  };
  void walk(const RangeImage& range, const Components& components);
  void note(const RangeImage& range, const Components& components, std::size_t here, std::size_t there);

  PairTable<Border> borders_;
  LabelUnion joined_;
  std::span<std::int32_t> outline_px_, pixels_;  // by component number
};

}  // namespace beltpick::segment
