#include "pipeline/object_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/random.hpp"
#include "pipeline/measured_normals.hpp"

namespace beltpick::pipeline {
namespace {

constexpr float kNormalRadius_mm = 1.6F;
// Writes measured points with their normals, those that have none left out.
class Sampler {
 public:
  Sampler(const RangeImage& range, std::span<OrientedPoint> out) : range_(range), out_(out) {}

  // Of a valid pixel; false where `out` has no room for another one.
  bool add(int row, int col) {
    if (pixels_.count == PixelBlock::kSize || count_ + static_cast<std::size_t>(pixels_.count) == out_.size()) run();
    if (count_ == out_.size()) return false;
    pixels_.add(row, col);
    return true;
  }
  // How many have been written, when all have been added.
  std::size_t finish() {
    run();
    return count_;
  }

 private:
  void run() {
    measured_normals(range_, pixels_, kNormalRadius_mm, normals_);
    for (std::size_t k = 0; k < static_cast<std::size_t>(pixels_.count); ++k) {
      if (normals_.found[k] != 0) out_[count_++] = {range_.point_mm(pixels_.row[k], pixels_.col[k]), normals_.at(k)};
    }
    pixels_.count = 0;
  }

  const RangeImage& range_;
  std::span<OrientedPoint> out_;
  PixelBlock pixels_;
  NormalBlock normals_;
  std::size_t count_ = 0;
};

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

std::size_t sample_object(const RangeImage& range, ImageView<const std::uint16_t> labels, const Object& object,
                          std::size_t wanted, std::uint64_t seed, std::span<OrientedPoint> out) {
  wanted = std::min(wanted, out.size());
  const int stride = std::max(1, static_cast<int>(std::sqrt(object.pixels / static_cast<double>(wanted))));
  Sampler sampler(range, out);
  for (int row = object.row_min; row <= object.row_max; row += stride) {
    for (int col = object.col_min; col <= object.col_max; col += stride) {
      if (!object.holds(labels(row, col)) || !range.valid(row, col)) continue;
      if (!sampler.add(row, col)) break;
    }
  }
  const std::size_t count = sampler.finish();
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
  Sampler sampler(range, out);
  for (std::size_t i = 0; i < asked; ++i) {
    const result::VisiblePoint& expected = visible[i * visible.size() / asked];
    if (!expected.in_image) continue;
    const int row = static_cast<int>(std::lround(expected.row_px));
    const int col = static_cast<int>(std::lround(expected.column_px));
    if (labels(row, col) == 0 || !range.valid(row, col)) continue;
    const Vec3f& measured = range.point_mm(row, col);
    if (std::abs(expected.normal.dot(measured - expected.point_mm)) > static_cast<float>(radius_mm)) continue;
    sampler.add(row, col);
  }
  return sampler.finish();
}

}  // namespace beltpick::pipeline
