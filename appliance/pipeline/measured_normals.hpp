// Normals of the measured surface, some pixels at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/stages.hpp"

namespace beltpick::pipeline {

// Pixels whose normals are asked for together; each has a valid point.
struct PixelBlock {
  static constexpr int kSize = 16;
  using Row = std::array<std::int32_t, kSize>;

  Row row{}, col{};
  int count = 0;

  void add(int at_row, int at_col) {
    const auto k = static_cast<std::size_t>(count++);
    row[k] = at_row, col[k] = at_col;
  }
};

// Unit vectors towards the camera, camera frame; where `found` is 0 there is none.
struct NormalBlock {
  alignas(64) std::array<float, PixelBlock::kSize> x, y, z;
  alignas(64) PixelBlock::Row found;

  [[nodiscard]] Vec3f at(std::size_t k) const { return {x[k], y[k], z[k]}; }
};

// The normals of the surface measured at some pixels: of a plane through the measured neighbours within about
// `radius_mm`, without those beyond a depth step. None where too few are left, or where they lie on a line.
void measured_normals(const RangeImage& range, const PixelBlock& pixels, float radius_mm, NormalBlock& normals);
// The same for one.
std::optional<Vec3f> measured_normal(const RangeImage& range, int row, int col, float radius_mm);

}  // namespace beltpick::pipeline
