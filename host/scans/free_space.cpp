#include "scans/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contract/lens_project.hpp"

namespace beltpick::scans {
namespace {

constexpr double kCell_mm = 1.2;
constexpr float kNone = std::numeric_limits<float>::max();
// A cell with fewer measured pixels may hide something in its gaps.
constexpr double kMeasuredShare = 0.75;

}  // namespace

FreeSpace::FreeSpace(const RangeImage& range, const Lens& lens, double pixel_mm)
    : lens_(lens),
      cell_px_(std::clamp(static_cast<int>(std::lround(kCell_mm / pixel_mm)), 1, 8)),
      rows_(range.point_mm.rows / cell_px_),
      cols_(range.point_mm.cols / cell_px_) {
  const auto count = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_);
  std::vector<float> own(count, kNone);
  std::vector<bool> known(count, false);
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < cols_; ++c) {
      const auto at = static_cast<std::size_t>(r) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(c);
      int measured = 0;
      for (int row = r * cell_px_; row < (r + 1) * cell_px_; ++row) {
        for (int col = c * cell_px_; col < (c + 1) * cell_px_; ++col) {
          if (!range.valid(row, col)) continue;
          ++measured;
          own[at] = std::min(own[at], range.point_mm(row, col).z());
        }
      }
      known[at] = measured >= kMeasuredShare * cell_px_ * cell_px_;
    }
  }
  nearest_mm_.assign(count, 0.0F);
  for (int r = 1; r + 1 < rows_; ++r) {
    for (int c = 1; c + 1 < cols_; ++c) {
      float nearest = kNone;
      bool all_known = true;
      for (int row = r - 1; row <= r + 1; ++row) {
        for (int col = c - 1; col <= c + 1; ++col) {
          const auto at =
              static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col);
          nearest = std::min(nearest, own[at]);
          all_known = all_known && known[at];
        }
      }
      const auto at = static_cast<std::size_t>(r) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(c);
      if (all_known) nearest_mm_[at] = nearest;
    }
  }
}

double FreeSpace::in_front_mm(const Vec3& point_camera_mm) const {
  if (!in_field(lens_, point_camera_mm)) return 0.0;
  const PixelPosition pixel = project(lens_, point_camera_mm);
  const int r = static_cast<int>(std::floor((pixel.row_px + 0.5) / cell_px_));
  const int c = static_cast<int>(std::floor((pixel.column_px + 0.5) / cell_px_));
  if (r < 0 || c < 0 || r >= rows_ || c >= cols_) return 0.0;
  const float nearest =
      nearest_mm_[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(c)];
  return nearest > 0.0F ? static_cast<double>(nearest) - point_camera_mm.z() : 0.0;
}

}  // namespace beltpick::scans
