// Connected components of the pixels of a mask under the links of equations (1) and (2).
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "segment/scale.hpp"

namespace beltpick::segment {

// Two neighbouring pixels hold together when their points lie closer than the threshold d at their range.
inline bool linked(const Vec3f& a, const Vec3f& b, const Scale& scale) {
  const double step_mm = scale.step_mm(0.5 * static_cast<double>(a.z() + b.z()));
  return static_cast<double>((a - b).squaredNorm()) < step_mm * step_mm;
}

class Components {
 public:
  Components(Arena& arena, int max_pixels);

  // Numbers the components of `mask` (rows x cols, nonzero: belongs) from 1 in raster order of their first pixels, and
  // leaves out those below `min_pixels` (0 in the result). At most 65,534: the rest is left out.
  // Returns how many there are; `label` gives a pixel's number.
  int find(const RangeImage& range, std::span<const std::uint8_t> mask, const Scale& scale, int min_pixels);

  [[nodiscard]] std::uint16_t label(std::size_t pixel) const { return numbers_[pixel]; }
  [[nodiscard]] std::span<std::uint16_t> labels() { return numbers_; }
  [[nodiscard]] std::span<const std::uint16_t> labels() const { return numbers_; }

 private:
  std::int32_t root(std::int32_t pixel);
  void unite(std::int32_t a, std::int32_t b);

  std::span<std::int32_t> parent_;  // a forest over pixels; -1 outside the mask
  std::span<std::int32_t> size_;    // at roots
  std::span<std::uint16_t> numbers_;
};

}  // namespace beltpick::segment
