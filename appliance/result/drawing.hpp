// Drawing: a part in an assumed pose as the camera would see it: which of its surface points are in sight, drawn at
// reduced resolution into a depth buffer.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "contract/part_model.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

// A surface point that nothing of the part itself hides.
struct VisiblePoint {
  Vec3f point_mm;           // camera frame
  Vec3f normal;             // camera frame
  float column_px, row_px;  // where it appears; may lie outside the image
  float area;               // across the line of sight, relative to a point of the template seen straight on
  bool in_image;
};

class Drawing {
 public:
  Drawing(Arena& arena, const Limits& limits);

  // Draws a part by its fine or its coarse surface. A surface that leans away by more than about 78 degrees counts as
  // out of sight: it is rarely measured.
  void draw(const SurfaceBlocks& surface, const PartPose& T_camera_part, const Lens& lens);

  [[nodiscard]] std::span<const VisiblePoint> visible() const { return visible_.first(visible_count_); }

  // The depth buffer: cells of factor() x factor() pixels, the first at (row_px(), column_px()) of the image; depth 0
  // where the part is not. It covers the part and a cell of margin, clipped to a quarter image beyond the border.
  [[nodiscard]] ImageView<const float> depth_mm() const { return depth_; }
  // The surface point that a cell shows, camera frame, and where it appears. The cell must not be empty.
  struct Shown {
    Vec3f point_mm;
    Vec3f normal;
    float column_px, row_px;
  };
  [[nodiscard]] Shown shown(int row, int col) const {
    const Projected& p = front_[index_(row, col)];
    return {p.point_mm, p.normal, p.column_px, p.row_px};
  }

  [[nodiscard]] int factor() const { return factor_; }
  // Points of the template, each of those drawn.
  [[nodiscard]] float stands_for() const { return stands_for_; }
  [[nodiscard]] int row_px() const { return row_px_; }
  [[nodiscard]] int column_px() const { return column_px_; }
  [[nodiscard]] Region region() const {
    return {row_px_, row_px_ + depth_.rows * factor_, column_px_, column_px_ + depth_.cols * factor_};
  }

 private:
  struct Projected {
    Vec3f point_mm;
    Vec3f normal;
    float column_px, row_px;
    float cosine;
    float own_mm;  // by so much the surface changes its own depth within a cell and a splat
  };
  void project_front(const SurfaceBlocks& surface, const PartPose& T_camera_part, const Lens& lens);
  void lay_out(double spacing_mm, const Lens& lens);
  void splat(double spacing_mm, const Lens& lens);
  void read_nearest();
  void keep_visible(const Lens& lens);

  std::span<Projected> front_;
  std::size_t front_count_ = 0;
  std::span<VisiblePoint> visible_;
  std::size_t visible_count_ = 0;
  std::span<std::uint64_t> nearest_;  // of each cell: depth, and which point's it is
  std::span<float> cells_;
  std::span<std::uint16_t> index_cells_;
  ImageView<float> depth_;
  ImageView<std::uint16_t> index_;  // into front_
  int factor_ = 4, row_px_ = 0, column_px_ = 0;
  float stands_for_ = 1.0F;
};

}  // namespace beltpick::result
