// Blemishes: places where the image contradicts a pose in one piece: surface of the part that was seen through, and
// holes of the part that were found filled. Shares of the whole part hide them: a bore in the wrong place, all that
// tells a part from its mirror image, is a few hundredths of the surface. Noise, flying pixels and outlines that are a
// pixel off contradict too, but in single cells and thin lines.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "contract/limits.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

// The largest of each kind, as the camera sees it; 0 where nothing is thick enough to count.
struct Blemishes {
  double seen_through_mm2 = 0.0;  // surface of the part behind which something was measured
  double filled_mm2 = 0.0;        // a hole of the part with a measured surface level with its rim

  [[nodiscard]] bool any() const { return seen_through_mm2 > 0.0 || filled_mm2 > 0.0; }
};

class BlemishFinder {
 public:
  BlemishFinder(Arena& arena, const Limits& limits);

  // Looks the drawn part up in the range image, a pixel a cell of the drawing. Allocates nothing.
  Blemishes find(const Drawing& drawing, const Scene& scene, double spacing_mm);

 private:
  enum class Cell : std::uint8_t { kPlain, kSeenThrough, kFilled, kOutside };
  // Cells of the drawing from (row, col) on, along a row or a column.
  struct Line {
    int row, col, down, right;
    [[nodiscard]] int row_at(int i) const { return row + i * down; }
    [[nodiscard]] int col_at(int i) const { return col + i * right; }
  };

  void mark_seen_through(const Drawing& drawing, const Scene& scene, float margin_mm);
  void mark_outside(const Drawing& drawing);
  void mark_filled(const Drawing& drawing, const Scene& scene, float margin_mm);
  [[nodiscard]] bool in_hole(const Drawing& drawing, int row, int col) const;
  void mark_covered(const Drawing& drawing, const Scene& scene, float margin_mm, const Line& line);
  [[nodiscard]] bool thick(int row, int col, Cell kind) const;
  int largest(Cell kind);
  int flood(std::int32_t start, Cell kind);

  ImageView<Cell> cells_;
  std::span<Cell> memory_;
  std::span<std::uint8_t> visited_;
  std::span<std::int32_t> queue_;
};

}  // namespace beltpick::result
