// Roster: the final list of objects: numbered anew, the largest where there are too many, each with its extent.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"

namespace beltpick::segment {

class Roster {
 public:
  Roster(Arena& arena, int max_segments);

  // Writes `labels` (a pixel each, 0: none) from component `numbers`, and lists the objects, top left first.
  // `height_mm`: of each pixel above the belt. Returns how many objects there are in all.
  int list(const RangeImage& range, std::span<const std::uint16_t> numbers, std::span<const float> height_mm,
           std::span<std::uint16_t> labels);

  [[nodiscard]] std::span<const Segment> segments() const { return segments_.first(count_); }

 private:
  void choose(std::span<const std::uint16_t> numbers, int& total);
  void measure(const RangeImage& range, std::span<const float> height_mm, std::span<const std::uint16_t> labels);

  std::span<Segment> segments_;
  std::span<std::int32_t> pixels_, sorted_;  // by component number
  std::span<std::uint16_t> label_of_number_;
  std::size_t count_ = 0;
};

}  // namespace beltpick::segment
