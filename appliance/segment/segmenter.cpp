#include "segment/segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/kernel.hpp"

namespace beltpick::segment {

namespace {

// An object rises above what carries it by more than that surface's own spread, and by more than two pixels see.
constexpr double kSpreads = 2.4;
constexpr double kPitches = 2.0;
// Fewer pixels than this are no object.
constexpr int kMinPixels = 100;

static_assert(sizeof(Vec3f) == 3 * sizeof(float));

// How far a point must rise above a plane to belong to an object.
struct Rise {
  double normal[3], offset_mm;
  double least_mm;   // anywhere, and
  double pitch_rad;  // kPitches of what neighbouring pixels see apart at its distance
};

// `xyz`: three numbers a pixel, mm. Writes 0 where nothing was measured.
BELTPICK_KERNEL void mark_risen(const float* __restrict xyz, const Rise& rise, std::size_t pixels,
                                float* __restrict height_mm, std::uint8_t* __restrict mask) {
  for (std::size_t p = 0; p < pixels; ++p) {
    const double x = xyz[3 * p], y = xyz[3 * p + 1], z = xyz[3 * p + 2];
    const auto height =
        static_cast<float>(rise.normal[0] * x + (rise.normal[1] * y + rise.normal[2] * z) - rise.offset_mm);
    const double by_pitch = kPitches * (rise.pitch_rad * z);
    const double least = rise.least_mm > by_pitch ? rise.least_mm : by_pitch;
    const bool measured = z > 0.0;
    height_mm[p] = measured ? height : 0.0F;
    mask[p] = static_cast<std::uint8_t>(measured & (static_cast<double>(height) > least));
  }
}

BELTPICK_KERNEL void unmark_poor(const float* __restrict sigma_mm, double poor_mm, std::size_t pixels,
                                 std::uint8_t* __restrict mask) {
  for (std::size_t p = 0; p < pixels; ++p) {
    const bool poor = static_cast<double>(sigma_mm[p]) > poor_mm;
    mask[p] = static_cast<std::uint8_t>(poor ? 0 : mask[p]);
  }
}

}  // namespace

Segmenter::Segmenter(Arena& arena, const Limits& limits, CreaseCut creases)
    : plane_finder_(arena),
      components_(arena, limits.image_width * limits.image_height),
      cavities_(arena),
      fragments_(arena),
      roster_(arena, limits.segments) {
  const auto pixels = static_cast<std::size_t>(limits.image_width) * static_cast<std::size_t>(limits.image_height);
  mask_ = arena.take_scratch<std::uint8_t>(Phase::kLocate, "segment: mask", pixels);
  opened_ = arena.take_scratch<std::uint8_t>(Phase::kLocate, "segment: mask", pixels);
  height_mm_ = arena.take_scratch<float>(Phase::kLocate, "segment: height", pixels);
  labels_ = arena.take<std::uint16_t>("segment: labels", pixels);
  if (creases == CreaseCut::kAvailable) creases_.emplace(arena, limits.image_width * limits.image_height);
}

// Without a support plane everything measured belongs to objects, and what is nearer is higher.
void Segmenter::mark_objects(const RangeImage& range, const Scale& scale, const std::optional<SupportPlane>& support) {
  const std::size_t pixels = range.point_mm.size();
  const Vec3 normal = support ? support->plane.normal : Vec3(0.0, 0.0, -1.0);
  const Rise rise{{normal.x(), normal.y(), normal.z()},
                  support ? support->plane.offset_mm : 0.0,
                  support ? kSpreads * support->spread_mm : -std::numeric_limits<double>::max(),
                  support ? scale.pitch_rad : -std::numeric_limits<double>::max()};
  mark_risen(reinterpret_cast<const float*>(range.point_mm.data), rise, pixels, height_mm_.data(), mask_.data());
  if (scale.poor_sigma_mm > 0.0) unmark_poor(range.sigma_mm.data, scale.poor_sigma_mm, pixels, mask_.data());
}

// Erosion and dilation by a cross: links one pixel wide fall away. Beyond the border lies what lies on it.
void Segmenter::open_mask(int rows, int cols) {
  const auto cross = [cols, rows](const std::uint8_t* from, std::uint8_t* to, auto combine) {
    for (int row = 0; row < rows; ++row) {
      const std::uint8_t* here = from + row * cols;
      const std::uint8_t* above = row > 0 ? here - cols : here;
      const std::uint8_t* below = row + 1 < rows ? here + cols : here;
      std::uint8_t* out = to + row * cols;
      const auto at = [&](int col, int left, int right) {
        const std::uint8_t beside = combine(here[left], here[right]);
        out[col] = combine(combine(beside, here[col]), combine(above[col], below[col]));
      };
      at(0, 0, std::min(1, cols - 1));
      for (int col = 1; col + 1 < cols; ++col) at(col, col - 1, col + 1);
      at(cols - 1, std::max(0, cols - 2), cols - 1);
    }
  };
  using Byte = std::uint8_t;
  cross(mask_.data(), opened_.data(), [](Byte a, Byte b) { return std::min(a, b); });
  cross(opened_.data(), mask_.data(), [](Byte a, Byte b) { return std::max(a, b); });
}

// Poorly measured pixels may not link objects, but belong to the one they lie on.
void Segmenter::return_poor_pixels(const RangeImage& range, const Scale& scale) {
  if (scale.poor_sigma_mm <= 0.0) return;
  const int cols = range.point_mm.cols;
  const auto labels = components_.labels();
  for (int row = 0; row < range.point_mm.rows; ++row) {
    for (int col = 1; col < cols; ++col) {
      const int here = row * cols + col;
      if (labels[here - 1] == 0 || labels[here] != 0) continue;
      const bool poor = static_cast<double>(range.sigma_mm.data[here]) > scale.poor_sigma_mm;
      if (!poor || !range.valid(row, col)) continue;
      if (linked(range.point_mm(row, col - 1), range.point_mm(row, col), scale)) labels[here] = labels[here - 1];
    }
  }
}

Segmented Segmenter::segment(const RangeImage& range, const SegmentOptions& options) {
  const int rows = range.point_mm.rows;
  const int cols = range.point_mm.cols;
  Segmented result;
  result.labels = {labels_.data(), rows, cols};
  std::fill(labels_.begin(), labels_.begin() + static_cast<std::ptrdiff_t>(range.point_mm.size()), std::uint16_t{0});
  const Scale scale = measure_scale(range);
  if (scale.pitch_rad <= 0.0) return result;
  const std::optional<SupportPlane> support =
      options.belt ? plane_finder_.measure(range, scale, *options.belt) : plane_finder_.find(range, scale);
  if (support) result.belt = support->plane;
  mark_objects(range, scale, support);
  open_mask(rows, cols);
  const int count = components_.find(range, mask_, scale, kMinPixels);
  if (result.belt) cavities_.join(range, height_mm_, result.belt->normal, scale, components_, count);
  if (options.cut_creases && creases_) creases_->cut(range, scale, components_, count, mask_, kMinPixels);
  return_poor_pixels(range, scale);
  if (options.join_fragments) fragments_.join(range, components_);
  const int objects = roster_.list(range, components_.labels().first(range.point_mm.size()), height_mm_, labels_);
  result.segments = roster_.segments();
  result.left_out = objects - static_cast<int>(result.segments.size());
  return result;
}

}  // namespace beltpick::segment
