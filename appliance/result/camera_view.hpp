// What the camera sees of a block of points: where they appear, and how much each faces it.
#pragma once

#include <array>

#include "base/point_block.hpp"
#include "contract/calibration.hpp"

namespace beltpick::result {

// The lens's plain numbers, as contract/lens_project.hpp uses them.
struct Optics {
  float fx, fy, cx, cy, k1, k2, p1, p2, k3;
  float left, right, top, bottom;  // of the field: see in_field()

  explicit Optics(const Lens& lens);
};

struct Seen {
  alignas(64) PointBlock::Row column_px, row_px;
  alignas(64) PointBlock::Row cosine;                     // between the normal and the line of sight
  alignas(64) PointBlock::Row own_mm;                     // see look_at()
  alignas(64) std::array<int, PointBlock::kSize> facing;  // 1 where the surface faces the camera, in its field
};

// The image of the first `count` points of a block, camera frame: project() and in_field() of
// contract/lens_project.hpp, sixteen at a time, the same bits on every vector unit. `own_mm`: by so much the surface
// changes its own depth within three times `spacing_mm`. What lies behind the last point is not to be read.
void look_at(const PointBlock& at_camera, const Optics& optics, float spacing_mm, int count, Seen& seen);

}  // namespace beltpick::result
