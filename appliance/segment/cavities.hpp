// Joins what is seen of a hollow object above its front wall to that wall.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "segment/components.hpp"
#include "segment/pair_table.hpp"
#include "segment/scale.hpp"

namespace beltpick::segment {

// A depth step parts the inside of a bowl or a bore from the outside of its front wall. They are one object where the
// near side of the step is a wall (a solid object in front would show its top there), where what rises behind ends at
// the height of that wall's rim, and where the border is long against the wall.
class Cavities {
 public:
  explicit Cavities(Arena& arena);

  // Gives joined components one number in `components`. `height_mm`: of each pixel above the support plane with normal
  // `up` (camera frame, towards the camera).
  void join(const RangeImage& range, std::span<const float> height_mm, const Vec3& up, const Scale& scale,
            Components& components, int count);

 private:
  struct Border {
    int pixels = 0;
    int near_is_a = 0;          // border pixels at which the lower label is nearer to the camera
    double near_height_mm = 0;  // sums over the border
    double near_up = 0;
    int normals = 0;
  };
  static constexpr int kMaxComponents = 512;
  static constexpr int kBins = 128;

  struct Extent {
    int row_min, row_max, col_min, col_max;
    int pixels;
  };

  void measure_extents(const RangeImage& range, std::span<const float> height_mm, const Components& components);
  void walk_borders(const RangeImage& range, std::span<const float> height_mm, const Vec3& up,
                    const Components& components);
  void note(const RangeImage& range, std::span<const float> height_mm, const Vec3& up, const Components& components,
            std::size_t here, std::size_t there);
  [[nodiscard]] bool one_object(std::uint16_t a, std::uint16_t b, const Border& border, double tolerance_mm) const;
  [[nodiscard]] double top_mm(std::uint16_t label) const;

  PairTable<Border> borders_;
  LabelUnion joined_;
  std::span<Extent> extents_;
  std::span<int> histogram_;  // of heights, kBins a component
  double highest_mm_ = 1.0;
};

}  // namespace beltpick::segment
