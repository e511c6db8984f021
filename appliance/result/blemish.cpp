#include "result/blemish.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace beltpick::result {
namespace {

// Cells all of whose neighbours agree, as many of them together: a blemish is at least four cells by four, and a cell
// is about as wide as the template's points lie apart.
constexpr int kLeastCore = 4;
// In tolerances of the surface: what bounced light or a rounded edge shifts is less.
constexpr double kMargins = 2.0;
// The face round a hole is looked for in so many cells of its rim; both ends of a cover lie on one face where their
// normals agree so well (cosine) and they are level to within this share of their distance.
constexpr int kRimCells = 4;
constexpr float kOneFace = 0.5F;
constexpr float kStepShare = 0.1F;

constexpr std::array<std::pair<int, int>, 4> kBeside{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

// What the pixel at the middle of a cell measured.
std::optional<Vec3f> measured_at(const Drawing& drawing, const Scene& scene, int row, int col) {
  const int r = drawing.row_px() + row * drawing.factor() + drawing.factor() / 2;
  const int c = drawing.column_px() + col * drawing.factor() + drawing.factor() / 2;
  if (!scene.range.point_mm.contains(r, c) || !scene.range.valid(r, c)) return {};
  return scene.range.point_mm(r, c);
}

// Of the first cells of a hole's rim, outward from (row, col), the one that faces the camera most: a hole's wall does
// not tell where its cover would lie.
Drawing::Shown rim(const Drawing& drawing, int row, int col, int down, int right) {
  const auto depth = drawing.depth_mm();
  const auto facing = [](const Drawing::Shown& at) { return -at.normal.dot(at.point_mm) / at.point_mm.norm(); };
  Drawing::Shown most = drawing.shown(row, col);
  for (int step = 1; step < kRimCells; ++step) {
    const int r = row + step * down, c = col + step * right;
    if (!depth.contains(r, c) || depth(r, c) == 0.0F) break;
    const Drawing::Shown next = drawing.shown(r, c);
    if (facing(next) > facing(most)) most = next;
  }
  return most;
}

// The surface that would close a hole, camera frame: from a flat one to one bulging along the normal.
struct Cover {
  Vec3f rim_mm, normal;
  float bulge_mm;

  [[nodiscard]] bool holds(const Vec3f& measured_mm, float margin_mm) const {
    const float height_mm = normal.dot(measured_mm - rim_mm);
    return height_mm > std::min(0.0F, bulge_mm) - margin_mm && height_mm < std::max(0.0F, bulge_mm) + margin_mm;
  }
};

// That between two places of the hole's rim, if they are of one face.
std::optional<Cover> cover_between(const Drawing::Shown& one, const Drawing::Shown& other) {
  if (one.normal.dot(other.normal) < kOneFace) return {};
  const Vec3f chord = other.point_mm - one.point_mm;
  const Vec3f normal = (one.normal + other.normal).normalized();
  if (std::abs(normal.dot(chord)) > kStepShare * chord.norm()) return {};
  // Tangents at both ends of an arc meet a quarter of chord times turn above the chord.
  return Cover{one.point_mm, normal, 0.25F * (other.normal - one.normal).dot(chord)};
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

// Within a hole, a surface that carries on the face round it from rim to rim, along rows and columns: where the far rim
// shows the hole's wall one way, it shows the face the other way.
void BlemishFinder::mark_filled(const Drawing& drawing, const Scene& scene, float margin_mm) {
  for (int row = 1; row + 1 < cells_.rows; ++row) {
    for (int col = 1; col + 1 < cells_.cols; ++col) {
      if (!in_hole(drawing, row, col)) continue;
      if (!in_hole(drawing, row, col - 1)) mark_covered(drawing, scene, margin_mm, {row, col, 0, 1});
      if (!in_hole(drawing, row - 1, col)) mark_covered(drawing, scene, margin_mm, {row, col, 1, 0});
    }
  }
}

bool BlemishFinder::in_hole(const Drawing& drawing, int row, int col) const {
  return drawing.depth_mm()(row, col) == 0.0F && cells_(row, col) != Cell::kOutside;
}

// From the hole's first cell on a line to its last: a hole has a rim on both sides.
void BlemishFinder::mark_covered(const Drawing& drawing, const Scene& scene, float margin_mm, const Line& line) {
  int length = 1;
  while (in_hole(drawing, line.row_at(length), line.col_at(length))) ++length;
  const auto cover = cover_between(rim(drawing, line.row_at(-1), line.col_at(-1), -line.down, -line.right),
                                   rim(drawing, line.row_at(length), line.col_at(length), line.down, line.right));
  if (!cover) return;
  for (int i = 0; i < length; ++i) {
    const auto measured = measured_at(drawing, scene, line.row_at(i), line.col_at(i));
    if (measured && cover->holds(*measured, margin_mm)) cells_(line.row_at(i), line.col_at(i)) = Cell::kFilled;
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
