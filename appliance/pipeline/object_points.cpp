#include "pipeline/object_points.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "base/random.hpp"

namespace beltpick::pipeline {
namespace {

constexpr float kNormalRadius_mm = 1.6F;
constexpr int kHalfWindow = 2;  // in strides
constexpr int kLeastNeighbours = 7;

// How far apart neighbouring pixels see at this point, mm.
float pixel_pitch_mm(const RangeImage& range, int row, int col) {
  const Vec3f& here = range.point_mm(row, col);
  float pitch = 0.0F;
  for (const int step : {-1, 1}) {
    if (!range.point_mm.contains(row, col + step) || !range.valid(row, col + step)) continue;
    const float across = std::abs(range.point_mm(row, col + step).x() - here.x());
    if (pitch == 0.0F || across < pitch) pitch = across;
  }
  return pitch;
}

}  // namespace

void Object::add(const Segment& segment) {
  if (label_count == kMaxLabels) return;
  if (label_count == 0) {
    row_min = segment.row_min, row_max = segment.row_max, col_min = segment.col_min, col_max = segment.col_max;
  }
  labels[label_count++] = segment.label;
  row_min = std::min(row_min, segment.row_min);
  row_max = std::max(row_max, segment.row_max);
  col_min = std::min(col_min, segment.col_min);
  col_max = std::max(col_max, segment.col_max);
  pixels += segment.pixels;
}

std::optional<Vec3f> measured_normal(const RangeImage& range, int row, int col, float radius_mm) {
  const float pitch = pixel_pitch_mm(range, row, col);
  if (pitch <= 0.0F) return {};
  const int stride = std::clamp(static_cast<int>(std::lround(radius_mm / (kHalfWindow * pitch))), 1, 8);
  const Vec3f& here = range.point_mm(row, col);
  // Beyond the diagonal of the window on a surface leaning by 70 degrees there is a step.
  const float reach = 3.0F * 1.42F * pitch * static_cast<float>(stride * kHalfWindow);
  Vec3f sum = Vec3f::Zero();
  Eigen::Matrix3f square = Eigen::Matrix3f::Zero();
  int count = 0;
  for (int r = row - kHalfWindow * stride; r <= row + kHalfWindow * stride; r += stride) {
    for (int c = col - kHalfWindow * stride; c <= col + kHalfWindow * stride; c += stride) {
      if (!range.point_mm.contains(r, c) || !range.valid(r, c)) continue;
      const Vec3f arm = range.point_mm(r, c) - here;
      if (arm.squaredNorm() > reach * reach) continue;
      sum += arm;
      square.noalias() += arm * arm.transpose();
      ++count;
    }
  }
  if (count < kLeastNeighbours) return {};
  const Vec3f mean = sum / static_cast<float>(count);
  const Eigen::Matrix3f spread = square / static_cast<float>(count) - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
  axes.computeDirect(spread);
  // Points on a line have no normal.
  if (axes.eigenvalues()[1] < 0.02F * axes.eigenvalues()[2]) return {};
  const Vec3f normal = axes.eigenvectors().col(0);
  return normal.dot(here) > 0.0F ? Vec3f(-normal) : normal;
}

std::size_t sample_object(const RangeImage& range, ImageView<const std::uint16_t> labels, const Object& object,
                          std::size_t wanted, std::uint64_t seed, std::span<OrientedPoint> out) {
  wanted = std::min(wanted, out.size());
  const int stride = std::max(1, static_cast<int>(std::sqrt(object.pixels / static_cast<double>(wanted))));
  std::size_t count = 0;
  for (int row = object.row_min; row <= object.row_max; row += stride) {
    for (int col = object.col_min; col <= object.col_max && count < out.size(); col += stride) {
      if (!object.holds(labels(row, col)) || !range.valid(row, col)) continue;
      const auto normal = measured_normal(range, row, col, kNormalRadius_mm);
      if (normal) out[count++] = {range.point_mm(row, col), *normal};
    }
  }
  Random random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(out[i - 1], out[random.below(static_cast<std::uint32_t>(i))]);
  return std::min(count, wanted);
}

std::size_t sample_at_pose(const RangeImage& range, ImageView<const std::uint16_t> labels,
                           const result::Drawing& drawing, double radius_mm, std::size_t wanted,
                           std::span<OrientedPoint> out) {
  wanted = std::min(wanted, out.size());
  const auto visible = drawing.visible();
  const std::size_t stride = std::max<std::size_t>(1, visible.size() / std::max<std::size_t>(1, wanted));
  std::size_t count = 0;
  for (std::size_t i = 0; i < visible.size() && count < wanted; i += stride) {
    const result::VisiblePoint& expected = visible[i];
    if (!expected.in_image) continue;
    const int row = static_cast<int>(std::lround(expected.row_px));
    const int col = static_cast<int>(std::lround(expected.column_px));
    if (labels(row, col) == 0 || !range.valid(row, col)) continue;
    const Vec3f& measured = range.point_mm(row, col);
    if (std::abs(expected.normal.dot(measured - expected.point_mm)) > static_cast<float>(radius_mm)) continue;
    const auto normal = measured_normal(range, row, col, kNormalRadius_mm);
    if (normal) out[count++] = {measured, *normal};
  }
  return count;
}

}  // namespace beltpick::pipeline
