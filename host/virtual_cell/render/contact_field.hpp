// ContactField: the signed distance to a part's surface on a grid, for contact between settling parts.
#pragma once

#include <array>
#include <vector>

#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

class ContactField {
 public:
  // The grid is as fine against the part, whatever its size: 1.5 mm for one of 210 mm across.
  explicit ContactField(const ScenePart& part);

  // Farther distances are cut to this, two cells.
  [[nodiscard]] double band_mm() const { return band_mm_; }

  // Signed distance (negative inside), trilinear between exact values at the grid's corners; the band outside the grid.
  [[nodiscard]] double distance(const Vec3& point_part_mm) const;
  // The direction away from the surface, unit length.
  [[nodiscard]] Vec3 outward(const Vec3& point_part_mm) const;

 private:
  void measure(const Mesh& mesh);
  void sign(const Mesh& mesh);
  [[nodiscard]] std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size_[1] + j) * size_[0] + i;
  }
  [[nodiscard]] Vec3 corner(int i, int j, int k) const { return origin_mm_ + cell_mm_ * Vec3(i, j, k); }

  double cell_mm_ = 0.0;
  double band_mm_ = 0.0;
  Vec3 origin_mm_ = Vec3::Zero();
  std::array<int, 3> size_{};
  std::vector<float> distance_;
};

}  // namespace beltpick::virtual_cell
