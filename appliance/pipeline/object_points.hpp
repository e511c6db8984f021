// Samples of measured points with their normals, from the range image.
#pragma once

#include <cstdint>
#include <span>

#include "base/stages.hpp"
#include "result/drawing.hpp"

namespace beltpick::pipeline {

// The pixels that belong to one object under search: those of a few segments inside a box.
struct Object {
  static constexpr int kMaxLabels = 8;
  std::uint16_t labels[kMaxLabels] = {};
  int label_count = 0;
  int row_min = 0, row_max = 0, col_min = 0, col_max = 0;  // inclusive
  int pixels = 0;

  void add(const Segment& segment);
  [[nodiscard]] bool holds(std::uint16_t label) const {
    for (int i = 0; i < label_count; ++i) {
      if (labels[i] == label) return true;
    }
    return false;
  }
};

// About `wanted` points of the object on a regular lattice of its pixels, in a random order that depends on `seed`
// alone: any first part of it is a sample too. Returns how many were written to `out`.
std::size_t sample_object(const RangeImage& range, ImageView<const std::uint16_t> labels, const Object& object,
                          std::size_t wanted, std::uint64_t seed, std::span<OrientedPoint> out);

// What was measured, on any object, where the drawn part is in sight: about `wanted` points within `radius_mm` of its
// surface. `labels` 0 is left out. Returns how many were written to `out`.
std::size_t sample_at_pose(const RangeImage& range, ImageView<const std::uint16_t> labels,
                           const result::Drawing& drawing, double radius_mm, std::size_t wanted,
                           std::span<OrientedPoint> out);

}  // namespace beltpick::pipeline
