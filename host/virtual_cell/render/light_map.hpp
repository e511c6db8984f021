// LightMap: what is cached of a placed scene: for each pixel where in the projector's image it lies and how it shines.
#pragma once

#include <cstdint>
#include <vector>

#include "virtual_cell/render/caster.hpp"

namespace beltpick::virtual_cell {

struct LightMap {
  int rows = 0, cols = 0;
  // One a pixel, by its central ray; `direct` is 0 for edge pixels, whose light comes from edge_samples instead.
  std::vector<float> column_px, row_px, direct, ambient;
  std::vector<std::uint8_t> blur_level;
  std::vector<std::uint8_t> lit;        // by the central ray
  std::vector<Vec3f> point_mm;          // camera frame, central ray
  std::vector<std::uint16_t> instance;  // + 1; 0 the belt
  std::vector<Ink> ink;                 // of the whole pixel
  // Pixels on an outline, a shadow's border, a step or a print's edge: the mean of several rays.
  struct Edge {
    std::uint32_t pixel;
    std::uint32_t first;  // into edge_samples, samples_per_edge of them
  };
  std::vector<Edge> edges;
  std::vector<LightSample> edge_samples;  // `direct` already divided by their number
  int samples_per_edge = 0;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(rows) * cols; }
};

// The camera's rays of one rig, worked out once.
class RayTable {
 public:
  explicit RayTable(const RichLens& camera);
  // Direction with z = 1 through the pixel, moved by a fraction of a pixel, |offset| <= 0.5.
  [[nodiscard]] Vec3f at(int row, int col, float row_offset = 0.0F, float col_offset = 0.0F) const;

 private:
  int cols_;
  std::vector<Vec3f> ray_;  // with one pixel more on each side
};

// Casts one ray a pixel, then edge_samples squared rays through the pixels on edges. Two threads; the result does not
// depend on their number.
void fill_light_map(const RichLens& camera, const RayTable& rays, const Caster& caster, int edge_samples,
                    LightMap& map);

}  // namespace beltpick::virtual_cell
