// ContactField: the signed distance to a part's surface on a grid, for contact between settling parts.
#pragma once

#include <array>
#include <vector>

#include "virtual_cell/render/scene_part.hpp"

namespace beltpick::virtual_cell {

class ContactField {
 public:
  static constexpr double kCellMm = 1.5;
  static constexpr double kBandMm = 3.0;  // farther distances are cut to this

  explicit ContactField(const ScenePart& part);

  // Signed distance (negative inside), trilinear between exact values at the grid's corners; kBandMm outside the grid.
  [[nodiscard]] double distance(const Vec3& point_part_mm) const;
  // The direction away from the surface, unit length.
  [[nodiscard]] Vec3 outward(const Vec3& point_part_mm) const;

 private:
  void measure(const Mesh& mesh);
  void sign(const Mesh& mesh);
  [[nodiscard]] std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size_[1] + j) * size_[0] + i;
  }
  [[nodiscard]] Vec3 corner(int i, int j, int k) const { return origin_mm_ + kCellMm * Vec3(i, j, k); }

  Vec3 origin_mm_ = Vec3::Zero();
  std::array<int, 3> size_{};
  std::vector<float> distance_;
};

}  // namespace beltpick::virtual_cell
