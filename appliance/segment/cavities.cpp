#include "segment/cavities.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/each_set.hpp"

namespace beltpick::segment {

namespace {

constexpr int kReach_px = 3;  // a border may have unmeasured pixels between its sides
constexpr int kNormalWindow_px = 5;
constexpr int kNormalEvery = 4;   // border pixels
constexpr double kWallUp = 0.75;  // mean cosine to the vertical that still is a wall
constexpr double kBorderShare = 0.4;
constexpr double kSameHeight = 0.12;
constexpr double kTopShare = 0.98;

// How upright the surface of one component is around a pixel: the cosine between its normal and `up`.
std::optional<double> upness(const RangeImage& range, const Components& components, std::size_t pixel, const Vec3& up) {
  const int cols = range.point_mm.cols;
  const int row = static_cast<int>(pixel) / cols;
  const int col = static_cast<int>(pixel) % cols;
  const std::uint16_t label = components.label(pixel);
  const Vec3f origin = range.point_mm(row, col);
  Vec3f sum = Vec3f::Zero();
  Eigen::Matrix3f square = Eigen::Matrix3f::Zero();
  int count = 0;
  for (int r = row - kNormalWindow_px; r <= row + kNormalWindow_px; ++r) {
    for (int c = col - kNormalWindow_px; c <= col + kNormalWindow_px; ++c) {
      if (!range.point_mm.contains(r, c)) continue;
      if (components.label(static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) +
                           static_cast<std::size_t>(c)) != label)
        continue;
      const Vec3f arm = range.point_mm(r, c) - origin;
      sum += arm;
      square += arm * arm.transpose();
      ++count;
    }
  }
  if (count < 12) return {};
  const Vec3f mean = sum / static_cast<float>(count);
  const Eigen::Matrix3f spread = square / static_cast<float>(count) - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
  axes.computeDirect(spread);
  const Vec3 normal = axes.eigenvectors().col(0).cast<double>();
  return std::abs(normal.dot(up));
}

}  // namespace

Cavities::Cavities(Arena& arena)
    : borders_(arena),
      joined_(arena),
      extents_(arena.take<Extent>("segment: borders", kMaxComponents)),
      histogram_(arena.take<int>("segment: borders", static_cast<std::size_t>(kMaxComponents) * kBins)) {}

void Cavities::measure_extents(const RangeImage& range, std::span<const float> height_mm,
                               const Components& components) {
  std::fill(extents_.begin(), extents_.end(), Extent{range.point_mm.rows, -1, range.point_mm.cols, -1, 0});
  std::fill(histogram_.begin(), histogram_.end(), 0);
  highest_mm_ = 1.0;
  const auto labels = components.labels().first(range.point_mm.size());
  each_set(labels, [&](std::size_t p) { highest_mm_ = std::max(highest_mm_, static_cast<double>(height_mm[p])); });
  const auto cols = static_cast<std::size_t>(range.point_mm.cols);
  for (int row = 0; row < range.point_mm.rows; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * cols;
    each_set(labels.subspan(first, cols), [&](std::size_t at) {
      const std::size_t pixel = first + at;
      const int col = static_cast<int>(at);
      const std::uint16_t label = labels[pixel];
      if (label >= kMaxComponents) return;
      Extent& extent = extents_[label];
      extent.row_min = std::min(extent.row_min, row);
      extent.row_max = std::max(extent.row_max, row);
      extent.col_min = std::min(extent.col_min, col);
      extent.col_max = std::max(extent.col_max, col);
      ++extent.pixels;
      const double share = std::clamp(static_cast<double>(height_mm[pixel]) / highest_mm_, 0.0, 1.0);
      ++histogram_[label * kBins + std::min(kBins - 1, static_cast<int>(share * kBins))];
    });
  }
}

double Cavities::top_mm(std::uint16_t label) const {
  int below = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    below += histogram_[label * kBins + bin];
    if (below >= kTopShare * extents_[label].pixels) return highest_mm_ * (bin + 0.5) / kBins;
  }
  return highest_mm_;
}

void Cavities::note(const RangeImage& range, std::span<const float> height_mm, const Vec3& up,
                    const Components& components, std::size_t here, std::size_t there) {
  const std::uint16_t a = components.label(here);
  const std::uint16_t b = components.label(there);
  if (a == b || a == 0 || b == 0 || a >= kMaxComponents || b >= kMaxComponents) return;
  Border* border = borders_.of(a, b);
  if (border == nullptr) return;
  const bool here_is_near = range.point_mm.data[here].z() < range.point_mm.data[there].z();
  const std::size_t near = here_is_near ? here : there;
  ++border->pixels;
  if (components.label(near) == std::min(a, b)) ++border->near_is_a;
  border->near_height_mm += static_cast<double>(height_mm[near]);
  if (border->pixels % kNormalEvery != 1) return;
  if (const auto cosine = upness(range, components, near, up)) {
    border->near_up += *cosine;
    ++border->normals;
  }
}

void Cavities::walk_borders(const RangeImage& range, std::span<const float> height_mm, const Vec3& up,
                            const Components& components) {
  borders_.clear();
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  const auto labels = components.labels().first(range.point_mm.size());
  for (int row = 0; row < rows; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols);
    each_set(labels.subspan(first, static_cast<std::size_t>(cols)), [&](std::size_t at) {
      const std::size_t here = first + at;
      const int col = static_cast<int>(at);
      // The next measured object pixel to the right and below, across a gap.
      for (int step = 1; step <= kReach_px && col + step < cols; ++step) {
        if (components.label(here + static_cast<std::size_t>(step)) == 0) continue;
        note(range, height_mm, up, components, here, here + static_cast<std::size_t>(step));
        break;
      }
      for (int step = 1; step <= kReach_px && row + step < rows; ++step) {
        const std::size_t there = here + static_cast<std::size_t>(step) * static_cast<std::size_t>(cols);
        if (components.label(there) == 0) continue;
        note(range, height_mm, up, components, here, there);
        break;
      }
    });
  }
}

bool Cavities::one_object(std::uint16_t a, std::uint16_t b, const Border& border, double tolerance_mm) const {
  const std::uint16_t near = 2 * border.near_is_a > border.pixels ? a : b;
  const std::uint16_t far = near == a ? b : a;
  const Extent& wall = extents_[near];
  const int wall_px = std::max(wall.row_max - wall.row_min, wall.col_max - wall.col_min) + 1;
  if (border.normals == 0 || border.pixels < kBorderShare * wall_px) return false;
  if (border.near_up / border.normals > kWallUp) return false;
  const double rim_mm = border.near_height_mm / border.pixels;
  return std::abs(top_mm(far) - rim_mm) < kSameHeight * rim_mm + tolerance_mm;
}

void Cavities::join(const RangeImage& range, std::span<const float> height_mm, const Vec3& up, const Scale& scale,
                    Components& components, int count) {
  if (count < 2) return;
  measure_extents(range, height_mm, components);
  walk_borders(range, height_mm, up, components);
  joined_.clear();
  const double tolerance_mm = 2.0 * scale.sigma_mm(scale.noise_z_mm) + scale.pitch_mm(scale.noise_z_mm);
  for (const auto& entry : borders_.entries()) {
    if (entry.a != 0 && one_object(entry.a, entry.b, entry.count, tolerance_mm)) joined_.unite(entry.a, entry.b);
  }
  const auto labels = components.labels().first(range.point_mm.size());
  each_set(labels, [&](std::size_t p) { labels[p] = joined_.root(labels[p]); });
}

}  // namespace beltpick::segment
