#include "pipeline/object_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/random.hpp"

namespace beltpick::pipeline {
namespace {

constexpr float kNormalRadius_mm = 1.6F;
constexpr int kHalfWindow = 2;  // in strides
constexpr int kLeastNeighbours = 7;
constexpr float kLeastBreadth = 0.02F;  // of their spread, of that along the line they may lie on
constexpr int kTurnsToThinnest = 2;

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

// Second moments of points about their mean; all zero where they are too few.
struct Spread {
  float xx = 0.0F, yy = 0.0F, zz = 0.0F, xy = 0.0F, xz = 0.0F, yz = 0.0F;
};

// Of the points on a lattice of pixels round one, those within `reach` of its point.
Spread spread_round(const RangeImage& range, int row, int col, int stride, float reach) {
  const Vec3f& here = range.point_mm(row, col);
  Spread s;
  float x = 0.0F, y = 0.0F, z = 0.0F, count = 0.0F;
  const auto within = [stride](int middle, int size) {
    const int below = std::min(kHalfWindow, middle / stride),
              above = std::min(kHalfWindow, (size - 1 - middle) / stride);
    return std::pair{middle - below * stride, middle + above * stride};
  };
  const auto [row_min, row_max] = within(row, range.point_mm.rows);
  const auto [col_min, col_max] = within(col, range.point_mm.cols);
  for (int r = row_min; r <= row_max; r += stride) {
    for (int c = col_min; c <= col_max; c += stride) {
      const Vec3f& there = range.point_mm(r, c);
      const float ax = there.x() - here.x(), ay = there.y() - here.y(), az = there.z() - here.z();
      // Nothing is added of a point that does not count: a branch would be guessed wrong too often.
      const bool counts = range.valid(r, c) & (ax * ax + ay * ay + az * az <= reach * reach);
      const float dx = counts ? ax : 0.0F, dy = counts ? ay : 0.0F, dz = counts ? az : 0.0F;
      x += dx, y += dy, z += dz, count += counts ? 1.0F : 0.0F;
      s.xx += dx * dx, s.yy += dy * dy, s.zz += dz * dz, s.xy += dx * dy, s.xz += dx * dz, s.yz += dy * dz;
    }
  }
  if (count < static_cast<float>(kLeastNeighbours)) return {};
  const float per = 1.0F / count;
  x *= per, y *= per, z *= per;
  return {s.xx * per - x * x, s.yy * per - y * y, s.zz * per - z * z,
          s.xy * per - x * y, s.xz * per - x * z, s.yz * per - y * z};
}

// The direction in which points spread least; none where they lie on a line. The matrix of cofactors is the inverse but
// for a factor: it turns any vector towards that direction, by some hundred times at once where points lie on a
// surface.
std::optional<Vec3f> thinnest_direction(const Spread& s) {
  Eigen::Matrix3f cofactors;
  cofactors << s.yy * s.zz - s.yz * s.yz, s.xz * s.yz - s.xy * s.zz, s.xy * s.yz - s.xz * s.yy,  //
      s.xz * s.yz - s.xy * s.zz, s.xx * s.zz - s.xz * s.xz, s.xy * s.xz - s.xx * s.yz,           //
      s.xy * s.yz - s.xz * s.yy, s.xy * s.xz - s.xx * s.yz, s.xx * s.yy - s.xy * s.xy;
  int steepest = 0;
  cofactors.diagonal().maxCoeff(&steepest);
  Vec3f direction = cofactors.col(steepest);
  for (int turn = 0; turn < kTurnsToThinnest; ++turn) direction = cofactors * direction.normalized();
  direction.normalize();
  const Vec3f shrunk(s.xx * direction.x() + s.xy * direction.y() + s.xz * direction.z(),
                     s.xy * direction.x() + s.yy * direction.y() + s.yz * direction.z(),
                     s.xz * direction.x() + s.yz * direction.y() + s.zz * direction.z());
  // The other two eigenvalues, by their sum and product: of a ratio q the product is q / (1 + q)^2 of the sum's square.
  const float least = direction.dot(shrunk);
  const float sum = s.xx + s.yy + s.zz - least, product = cofactors.trace() - least * sum;
  constexpr float kLeastOfSquare = kLeastBreadth / ((1.0F + kLeastBreadth) * (1.0F + kLeastBreadth));
  if (!(product > kLeastOfSquare * sum * sum)) return {};
  return direction;
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
  // Beyond the diagonal of the window on a surface leaning by 70 degrees there is a step.
  const float reach = 3.0F * 1.42F * pitch * static_cast<float>(stride * kHalfWindow);
  const auto normal = thinnest_direction(spread_round(range, row, col, stride, reach));
  if (!normal) return {};
  return normal->dot(range.point_mm(row, col)) > 0.0F ? Vec3f(-*normal) : *normal;
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
  // Evenly from all of them: they come in the order in which they lie on the part.
  const std::size_t asked = std::min(visible.size(), wanted);
  std::size_t count = 0;
  for (std::size_t i = 0; i < asked; ++i) {
    const result::VisiblePoint& expected = visible[i * visible.size() / asked];
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
