#include "result/blemish.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace beltpick::result {
namespace {

// Cells all of whose neighbours agree, as many of them together: a blemish is at least four cells by four, and a cell
// is about as wide as the template's points lie apart.
constexpr int kLeastCore = 4;
// In tolerances of the surface: what bounced light or a rounded edge shifts is less.
constexpr double kMargins = 2.0;

constexpr std::array<std::pair<int, int>, 4> kBeside{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

// What the pixel at the middle of a cell measured.
std::optional<Vec3f> measured_at(const Drawing& drawing, const Scene& scene, int row, int col) {
  const int r = drawing.row_px() + row * drawing.factor() + drawing.factor() / 2;
  const int c = drawing.column_px() + col * drawing.factor() + drawing.factor() / 2;
  if (!scene.range.point_mm.contains(r, c) || !scene.range.valid(r, c)) return {};
  return scene.range.point_mm(r, c);
}

}  // namespace

BlemishFinder::BlemishFinder(Arena& arena, const Limits& limits) {
  const auto cells = static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height) / 4;
  memory_ = arena.take_scratch<Cell>(Phase::kLocate, "verify: blemishes", cells);
  visited_ = arena.take_scratch<std::uint8_t>(Phase::kLocate, "verify: blemishes", cells);
  queue_ = arena.take_scratch<std::int32_t>(Phase::kLocate, "verify: blemishes", cells);
}

Blemishes BlemishFinder::find(const Drawing& drawing, const Scene& scene, double spacing_mm) {
  const auto depth = drawing.depth_mm();
  if (depth.size() == 0) return {};
  cells_ = {memory_.data(), depth.rows, depth.cols};
  std::fill_n(memory_.begin(), depth.size(), Cell::kPlain);
  const auto margin_mm = static_cast<float>(kMargins * surface_tolerance_mm(scene, spacing_mm));
  mark_seen_through(drawing, scene, margin_mm);
  mark_outside(drawing);
  mark_filled(drawing, scene, margin_mm);
  float nearest_mm = 0.0F;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth.data[i] > 0.0F && (nearest_mm == 0.0F || depth.data[i] < nearest_mm)) nearest_mm = depth.data[i];
  }
  const double cell_mm = drawing.factor() * static_cast<double>(nearest_mm) / scene.lens.fx_px;
  return {largest(Cell::kSeenThrough) * cell_mm * cell_mm, largest(Cell::kFilled) * cell_mm * cell_mm};
}

void BlemishFinder::mark_seen_through(const Drawing& drawing, const Scene& scene, float margin_mm) {
  const auto depth = drawing.depth_mm();
  for (int row = 0; row < depth.rows; ++row) {
    for (int col = 0; col < depth.cols; ++col) {
      if (depth(row, col) == 0.0F) continue;
      const auto measured = measured_at(drawing, scene, row, col);
      if (!measured) continue;
      const Drawing::Shown shown = drawing.shown(row, col);
      const bool behind = measured->squaredNorm() > shown.point_mm.squaredNorm();
      if (behind && shown.normal.dot(*measured - shown.point_mm) < -margin_mm) cells_(row, col) = Cell::kSeenThrough;
    }
  }
}

// Empty cells from which the drawing's border can be reached over empty cells.
void BlemishFinder::mark_outside(const Drawing& drawing) {
  const auto depth = drawing.depth_mm();
  std::size_t count = 0;
  const auto enter = [&](int row, int col) {
    if (!depth.contains(row, col) || depth(row, col) != 0.0F || cells_(row, col) == Cell::kOutside) return;
    cells_(row, col) = Cell::kOutside;
    queue_[count++] = row * depth.cols + col;
  };
  for (int row = 0; row < depth.rows; ++row) enter(row, 0), enter(row, depth.cols - 1);
  for (int col = 0; col < depth.cols; ++col) enter(0, col), enter(depth.rows - 1, col);
  for (std::size_t next = 0; next < count; ++next) {
    for (const auto& [dr, dc] : kBeside) enter(queue_[next] / depth.cols + dr, queue_[next] % depth.cols + dc);
  }
}

// Within a hole, a surface between the depths of the rim to the left and to the right.
void BlemishFinder::mark_filled(const Drawing& drawing, const Scene& scene, float margin_mm) {
  const auto depth = drawing.depth_mm();
  for (int row = 0; row < depth.rows; ++row) {
    for (int first = 0; first < depth.cols; ++first) {
      if (depth(row, first) != 0.0F || cells_(row, first) == Cell::kOutside) continue;
      int end = first;
      while (depth(row, end) == 0.0F) ++end;  // a hole has a rim on both sides
      const auto [nearer, farther] = std::minmax(depth(row, first - 1), depth(row, end));
      for (int col = first; col < end; ++col) {
        const auto measured = measured_at(drawing, scene, row, col);
        if (!measured) continue;
        const bool level = measured->z() > nearer - margin_mm && measured->z() < farther + margin_mm;
        if (level) cells_(row, col) = Cell::kFilled;
      }
      first = end;
    }
  }
}

bool BlemishFinder::thick(int row, int col, Cell kind) const {
  if (row < 1 || col < 1 || row + 1 >= cells_.rows || col + 1 >= cells_.cols) return false;
  for (int dr = -1; dr <= 1; ++dr) {
    for (int dc = -1; dc <= 1; ++dc) {
      if (cells_(row + dr, col + dc) != kind) return false;
    }
  }
  return true;
}

// Of the regions of this kind, the most cells that are all surrounded by their own; 0 below the least.
int BlemishFinder::largest(Cell kind) {
  std::fill_n(visited_.begin(), cells_.size(), std::uint8_t{0});
  int most = 0;
  for (int row = 1; row + 1 < cells_.rows; ++row) {
    for (int col = 1; col + 1 < cells_.cols; ++col) {
      const int at = row * cells_.cols + col;
      if (visited_[static_cast<std::size_t>(at)] == 0 && thick(row, col, kind)) most = std::max(most, flood(at, kind));
    }
  }
  return most < kLeastCore ? 0 : most;
}

int BlemishFinder::flood(std::int32_t start, Cell kind) {
  std::size_t count = 0;
  const auto enter = [&](int row, int col) {
    const int at = row * cells_.cols + col;
    if (visited_[static_cast<std::size_t>(at)] != 0 || !thick(row, col, kind)) return;
    visited_[static_cast<std::size_t>(at)] = 1;
    queue_[count++] = at;
  };
  enter(start / cells_.cols, start % cells_.cols);
  for (std::size_t next = 0; next < count; ++next) {
    for (const auto& [dr, dc] : kBeside) enter(queue_[next] / cells_.cols + dr, queue_[next] % cells_.cols + dc);
  }
  return static_cast<int>(count);
}

}  // namespace beltpick::result
