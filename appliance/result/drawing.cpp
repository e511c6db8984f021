#include "result/drawing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "result/camera_view.hpp"

namespace beltpick::result {
namespace {

constexpr float kLeastCosine = 0.2F;
constexpr int kSplat = 3;
constexpr float kSplatShare = 0.7F;  // of the spacing: half the width of a point's square
constexpr std::uint64_t kNothing = ~std::uint64_t{0};

}  // namespace

Drawing::Drawing(Arena& arena, const Limits& limits)
    : front_(arena.take_scratch<Projected>(Phase::kLocate, "verify: points facing the camera",
                                           static_cast<std::size_t>(limits.template_points))),
      visible_(arena.take_scratch<VisiblePoint>(Phase::kLocate, "verify: points in sight",
                                                static_cast<std::size_t>(limits.template_points))),
      nearest_(arena.take_scratch<std::uint64_t>(
          Phase::kLocate, "verify: depth buffer",
          static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height) / 4)),
      cells_(arena.take_scratch<float>(
          Phase::kLocate, "verify: depth buffer",
          static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height) / 4)),
      index_cells_(arena.take_scratch<std::uint16_t>(
          Phase::kLocate, "verify: depth buffer",
          static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height) / 4)) {}

void Drawing::draw(const SurfaceBlocks& surface, const PartPose& T_camera_part, const Lens& lens) {
  project_front(surface, T_camera_part, lens);
  stands_for_ = surface.stands_for;
  visible_count_ = 0;
  depth_ = {};
  if (front_count_ == 0) return;
  lay_out(static_cast<double>(surface.spacing_mm), lens);
  splat(static_cast<double>(surface.spacing_mm), lens);
  read_nearest();
  keep_visible(lens);
}

void Drawing::project_front(const SurfaceBlocks& surface, const PartPose& T_camera_part, const Lens& lens) {
  const FastMotion motion(T_camera_part);
  const Optics optics(lens);
  front_count_ = 0;
  PointBlock at;
  Seen seen;
  for (std::size_t block = 0; block < surface.blocks.size(); ++block) {
    const auto count =
        static_cast<int>(std::min<std::size_t>(PointBlock::kSize, surface.count - block * PointBlock::kSize));
    move_points(surface.blocks[block], motion, count, at);
    look_at(at, optics, surface.spacing_mm, count, seen);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      if (seen.facing[k] == 0) continue;
      front_[front_count_++] = {{at.x[k], at.y[k], at.z[k]},
                                {at.nx[k], at.ny[k], at.nz[k]},
                                seen.column_px[k],
                                seen.row_px[k],
                                seen.cosine[k],
                                seen.own_mm[k]};
    }
  }
}

void Drawing::lay_out(double spacing_mm, const Lens& lens) {
  const auto front = front_.first(front_count_);
  float min_column = 1e9F, max_column = -1e9F, min_row = 1e9F, max_row = -1e9F, min_depth = 1e9F;
  for (const Projected& p : front) {
    min_column = std::min(min_column, p.column_px);
    max_column = std::max(max_column, p.column_px);
    min_row = std::min(min_row, p.row_px);
    max_row = std::max(max_row, p.row_px);
    min_depth = std::min(min_depth, p.point_mm.z());
  }
  // A cell about as wide as the points lie apart where they are nearest.
  const double spacing_px = spacing_mm * std::max(lens.fx_px, lens.fy_px) / static_cast<double>(min_depth);
  factor_ = std::clamp(static_cast<int>(std::lround(spacing_px)), 1, 64);
  for (;; ++factor_) {
    const int margin = 2 * factor_;
    column_px_ = static_cast<int>(std::floor(min_column)) - margin;
    row_px_ = static_cast<int>(std::floor(min_row)) - margin;
    const int cols = (static_cast<int>(std::ceil(max_column)) + margin - column_px_) / factor_ + 1;
    const int rows = (static_cast<int>(std::ceil(max_row)) + margin - row_px_) / factor_ + 1;
    depth_ = {cells_.data(), rows, cols};
    index_ = {index_cells_.data(), rows, cols};
    if (depth_.size() <= cells_.size()) break;
  }
}

// A point's square of cells, up to kSplat wide, is written as if it were that wide: cells beyond its end are those at
// its end once more, which the least of all depths does not mind, and no branch depends on the width.
void Drawing::splat(double spacing_mm, const Lens& lens) {
  std::fill_n(nearest_.begin(), depth_.size(), kNothing);
  const float focal_cells = static_cast<float>(std::max(lens.fx_px, lens.fy_px)) / static_cast<float>(factor_);
  const float cells_per_px = 1.0F / static_cast<float>(factor_);
  for (std::size_t i = 0; i < front_count_; ++i) {
    const Projected& p = front_[i];
    // A square a little wider than the spacing closes the gaps between points that are spread unevenly.
    const float half = kSplatShare * static_cast<float>(spacing_mm) * focal_cells / p.point_mm.z();
    const float column = (p.column_px - static_cast<float>(column_px_)) * cells_per_px;
    const float row = (p.row_px - static_cast<float>(row_px_)) * cells_per_px;
    const int first_row = std::max(0, static_cast<int>(row - half));
    const int last_row = std::min(depth_.rows - 1, static_cast<int>(row + half));
    const int first_col = std::max(0, static_cast<int>(column - half));
    const int last_col = std::min(depth_.cols - 1, static_cast<int>(column + half));
    // Depths are positive: their bits are in order as they are.
    const std::uint64_t drawn = static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(p.point_mm.z())) << 32 | i;
    for (int r = first_row; r <= last_row; r += kSplat) {
      for (int c = first_col; c <= last_col; c += kSplat) {
        for (int dr = 0; dr < kSplat; ++dr) {
          std::uint64_t* line = nearest_.data() + static_cast<std::ptrdiff_t>(std::min(r + dr, last_row)) * depth_.cols;
          for (int dc = 0; dc < kSplat; ++dc) {
            std::uint64_t& held = line[std::min(c + dc, last_col)];
            held = std::min(held, drawn);
          }
        }
      }
    }
  }
}

void Drawing::read_nearest() {
  for (std::size_t i = 0; i < depth_.size(); ++i) {
    const std::uint64_t held = nearest_[i];
    cells_[i] = held == kNothing ? 0.0F : std::bit_cast<float>(static_cast<std::uint32_t>(held >> 32));
    index_cells_[i] = static_cast<std::uint16_t>(held);
  }
}

void Drawing::keep_visible(const Lens& lens) {
  const float cells_per_px = 1.0F / static_cast<float>(factor_);
  for (const Projected& p : front_.first(front_count_)) {
    if (p.cosine < kLeastCosine) continue;
    const int row = static_cast<int>((p.row_px - static_cast<float>(row_px_)) * cells_per_px);
    const int col = static_cast<int>((p.column_px - static_cast<float>(column_px_)) * cells_per_px);
    if (!depth_.contains(row, col) || p.point_mm.z() > depth_(row, col) + p.own_mm) continue;
    const bool in_image = p.column_px >= 0.0F && p.row_px >= 0.0F &&
                          p.column_px <= static_cast<float>(lens.width - 1) &&
                          p.row_px <= static_cast<float>(lens.height - 1);
    visible_[visible_count_++] = {p.point_mm, p.normal, p.column_px, p.row_px, stands_for_ * p.cosine, in_image};
  }
}

}  // namespace beltpick::result
