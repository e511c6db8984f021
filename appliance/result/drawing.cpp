#include "result/drawing.hpp"

#include <algorithm>
#include <cmath>

#include "contract/lens_project.hpp"

namespace beltpick::result {
namespace {

constexpr float kLeastCosine = 0.2F;

}  // namespace

Drawing::Drawing(Arena& arena, const Limits& limits)
    : front_(arena.take_scratch<Projected>(Phase::kLocate, "verify: points facing the camera",
                                           static_cast<std::size_t>(limits.template_points))),
      visible_(arena.take_scratch<VisiblePoint>(Phase::kLocate, "verify: points in sight",
                                                static_cast<std::size_t>(limits.template_points))),
      cells_(arena.take_scratch<float>(
          Phase::kLocate, "verify: depth buffer",
          static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height) / 4)),
      index_cells_(arena.take_scratch<std::uint16_t>(
          Phase::kLocate, "verify: depth buffer",
          static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height) / 4)) {}

void Drawing::draw(const PartModel& model, const PartPose& T_camera_part, const Lens& lens) {
  project_front(model, T_camera_part, lens);
  visible_count_ = 0;
  depth_ = {};
  if (front_count_ == 0) return;
  lay_out(model, lens);
  splat(model.spacing_mm, lens);
  keep_visible(model.spacing_mm, lens);
}

void Drawing::project_front(const PartModel& model, const PartPose& T_camera_part, const Lens& lens) {
  const Eigen::Matrix3f rotation = T_camera_part.rotation.cast<float>();
  const Vec3f translation = T_camera_part.translation_mm.cast<float>();
  front_count_ = 0;
  for (const OrientedPoint& surface : model.surface) {
    const Vec3f point = rotation * surface.point_mm + translation;
    if (point.z() <= 1.0F) continue;
    const Vec3f normal = rotation * surface.normal;
    const float cosine = -normal.dot(point) / point.norm();
    if (cosine <= 0.02F || !in_field(lens, point.cast<double>())) continue;
    const PixelPosition at = project(lens, point.cast<double>());
    front_[front_count_++] = {point, normal, static_cast<float>(at.column_px), static_cast<float>(at.row_px), cosine};
  }
}

void Drawing::lay_out(const PartModel& model, const Lens& lens) {
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
  const double spacing_px = model.spacing_mm * std::max(lens.fx_px, lens.fy_px) / static_cast<double>(min_depth);
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
  std::fill_n(cells_.begin(), depth_.size(), 0.0F);
}

void Drawing::splat(double spacing_mm, const Lens& lens) {
  const float focal_cells = static_cast<float>(std::max(lens.fx_px, lens.fy_px)) / static_cast<float>(factor_);
  const float cells_per_px = 1.0F / static_cast<float>(factor_);
  for (std::size_t i = 0; i < front_count_; ++i) {
    const Projected& p = front_[i];
    // A square a little wider than the spacing closes the gaps between points that are spread unevenly.
    const float half = 0.7F * static_cast<float>(spacing_mm) * focal_cells / p.point_mm.z();
    const float column = (p.column_px - static_cast<float>(column_px_)) * cells_per_px;
    const float row = (p.row_px - static_cast<float>(row_px_)) * cells_per_px;
    const int first_row = std::max(0, static_cast<int>(row - half));
    const int last_row = std::min(depth_.rows - 1, static_cast<int>(row + half));
    const int first_col = std::max(0, static_cast<int>(column - half));
    const int last_col = std::min(depth_.cols - 1, static_cast<int>(column + half));
    for (int r = first_row; r <= last_row; ++r) {
      for (int c = first_col; c <= last_col; ++c) {
        float& held = depth_(r, c);
        if (held != 0.0F && p.point_mm.z() >= held) continue;
        held = p.point_mm.z();
        index_(r, c) = static_cast<std::uint16_t>(i);
      }
    }
  }
}

void Drawing::keep_visible(double spacing_mm, const Lens& lens) {
  const float cells_per_px = 1.0F / static_cast<float>(factor_);
  for (const Projected& p : front_.first(front_count_)) {
    if (p.cosine < kLeastCosine) continue;
    const int row = static_cast<int>((p.row_px - static_cast<float>(row_px_)) * cells_per_px);
    const int col = static_cast<int>((p.column_px - static_cast<float>(column_px_)) * cells_per_px);
    // Within a cell and a splat a leaning surface changes its own depth by this much.
    const float slope = std::sqrt(1.0F - p.cosine * p.cosine) / p.cosine;
    const float own_mm = static_cast<float>(spacing_mm) * (1.0F + 2.0F * slope);
    if (!depth_.contains(row, col) || p.point_mm.z() > depth_(row, col) + own_mm) continue;
    const bool in_image = p.column_px >= 0.0F && p.row_px >= 0.0F &&
                          p.column_px <= static_cast<float>(lens.width - 1) &&
                          p.row_px <= static_cast<float>(lens.height - 1);
    visible_[visible_count_++] = {p.point_mm, p.normal, p.column_px, p.row_px, p.cosine, in_image};
  }
}

}  // namespace beltpick::result
