#include "explain/crop.hpp"

#include <algorithm>
#include <cmath>

#include "contract/lens_project.hpp"
#include "html/plot.hpp"

namespace beltpick::explain {
namespace {

// From this share of the scale on the colours are at their fullest: most of what is there lies well within it.
constexpr double kFullColour = 0.25;

constexpr Rgb kOnPrimitive{60, 190, 90};
constexpr Rgb kOffPrimitive{170, 170, 175};
constexpr Rgb kAxis{230, 40, 40};

Rgb dimmed(std::uint8_t level) {
  const auto grey = static_cast<std::uint8_t>(20 + level / 3);
  return {grey, grey, grey};
}

Picture dim(ImageView<const std::uint8_t> grey, const Frame& frame) {
  Picture picture(frame.rows, frame.cols);
  for (int r = 0; r < frame.rows; ++r) {
    for (int c = 0; c < frame.cols; ++c) picture.view()(r, c) = dimmed(grey(frame.row + r, frame.col + c));
  }
  return picture;
}

// A square of pixels; `row`, `col` of the whole image.
void dab(Picture& picture, const Frame& frame, int row, int col, int reach, const Rgb& colour) {
  for (int r = row - reach; r <= row + reach; ++r) {
    for (int c = col - reach; c <= col + reach; ++c) {
      if (picture.view().contains(r - frame.row, c - frame.col)) picture.view()(r - frame.row, c - frame.col) = colour;
    }
  }
}

double off_primitive_mm(const Primitive& primitive, const Vec3& at) {
  const Vec3 arm = at - primitive.point_mm;
  if (primitive.kind == PrimitiveKind::kPlane) return arm.dot(primitive.direction);
  if (primitive.kind == PrimitiveKind::kSphere) return arm.norm() - primitive.radius_mm;
  return (arm - arm.dot(primitive.direction) * primitive.direction).norm() - primitive.radius_mm;
}

void draw_axis(Picture& picture, const Frame& frame, const Primitive& primitive, const Lens& lens) {
  constexpr int kSteps = 600;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const Vec3 at = primitive.point_mm + 0.7 * primitive.extent_mm * k / kSteps * primitive.direction;
    if (!in_field(lens, at)) continue;
    const PixelPosition place = project(lens, at);
    dab(picture, frame, static_cast<int>(std::lround(place.row_px)), static_cast<int>(std::lround(place.column_px)), 1,
        kAxis);
  }
}

// Calls `visit(row, col, point)` for every measured point of the object.
template <class Visit>
void for_object(const result::Scene& scene, const pipeline::Object& object, const Frame& frame, const Visit& visit) {
  for (int row = frame.row; row < frame.row + frame.rows; ++row) {
    for (int col = frame.col; col < frame.col + frame.cols; ++col) {
      if (object.holds(scene.labels(row, col)) && scene.range.valid(row, col))
        visit(row, col, scene.range.point_mm(row, col));
    }
  }
}

}  // namespace

Rgb finding_colour(result::Finding finding) {
  constexpr std::array<Rgb, result::kFindingCount> kColours{
      {{60, 180, 80}, {225, 40, 40}, {70, 120, 235}, {245, 150, 30}, {240, 220, 70}, {150, 120, 190}}};
  return kColours[static_cast<std::size_t>(finding)];
}

const char* finding_name(result::Finding finding) {
  constexpr std::array<const char*, result::kFindingCount> kNames{
      "measured there",           "seen to be empty", "hidden by something in front",
      "measured off the surface", "not measured",     "in a shadow"};
  return kNames[static_cast<std::size_t>(finding)];
}

Frame Frame::round(const Segment& segment, int image_rows, int image_cols) {
  const int margin = 12 + std::max(segment.row_max - segment.row_min, segment.col_max - segment.col_min) / 8;
  Frame frame;
  frame.row = std::clamp(segment.row_min - margin, 0, image_rows - 1);
  frame.col = std::clamp(segment.col_min - margin, 0, image_cols - 1);
  frame.rows = std::clamp(segment.row_max + margin - frame.row + 1, 1, image_rows - frame.row);
  frame.cols = std::clamp(segment.col_max + margin - frame.col + 1, 1, image_cols - frame.col);
  return frame;
}

Picture range_crop(const RangeImage& range, const Frame& frame) {
  std::vector<float> z_mm(static_cast<std::size_t>(frame.rows) * static_cast<std::size_t>(frame.cols));
  const ImageView<float> view(z_mm.data(), frame.rows, frame.cols);
  for (int r = 0; r < frame.rows; ++r) {
    for (int c = 0; c < frame.cols; ++c) view(r, c) = range.point_mm(frame.row + r, frame.col + c).z();
  }
  return contract_io::range_picture(view);
}

Picture label_crop(ImageView<const std::uint16_t> labels, ImageView<const std::uint8_t> grey, const Frame& frame) {
  return cut(contract_io::labels_picture(labels, grey), frame);
}

InlierPicture inlier_crop(const result::Scene& scene, const pipeline::Object& object, const Primitive& primitive,
                          ImageView<const std::uint8_t> grey, const Frame& frame) {
  InlierPicture made{dim(grey, frame)};
  const double within_mm = 3.0 * std::max(scene.noise_mm, 0.1);
  for_object(scene, object, frame, [&](int row, int col, const Vec3f& point) {
    const bool on_it = std::abs(off_primitive_mm(primitive, point.cast<double>())) < within_mm;
    made.on_it += on_it ? 1 : 0;
    ++made.pixels;
    dab(made.picture, frame, row, col, 0, on_it ? kOnPrimitive : kOffPrimitive);
  });
  if (primitive.kind == PrimitiveKind::kCylinder) draw_axis(made.picture, frame, primitive, scene.lens);
  return made;
}

ResidualPicture residual_crop(const result::Scene& scene, const pipeline::Object& object, const PartModel& model,
                              const result::PartPose& T_camera_part, double scale_mm,
                              ImageView<const std::uint8_t> grey, const Frame& frame) {
  ResidualPicture made{dim(grey, frame), scale_mm};
  const auto T_part_camera = T_camera_part.inverse();
  std::vector<double> off;
  double square_mm2 = 0.0;
  int within = 0;
  for_object(scene, object, frame, [&](int row, int col, const Vec3f& point) {
    const Vec3f at = (T_part_camera * point.cast<double>()).cast<float>();
    const OrientedPoint& nearest = model.nearest(at);
    const Vec3f apart = at - nearest.point_mm;
    // Beside the part's end the distance is not across its surface.
    const bool beside = apart.norm() > 2.0F * model.spacing_mm + static_cast<float>(scale_mm);
    const double across = beside ? static_cast<double>(apart.norm()) : nearest.normal.dot(apart);
    off.push_back(std::abs(across));
    const bool shown = std::abs(across) <= scale_mm;
    if (shown) {
      square_mm2 += across * across;
      ++within;
    }
    dab(made.picture, frame, row, col, 0,
        shown ? html::diverging_colour(across / (kFullColour * scale_mm)) : Rgb{0, 0, 0});
  });
  if (off.empty()) return made;
  made.within_share = static_cast<double>(within) / static_cast<double>(off.size());
  made.rms_mm = within > 0 ? std::sqrt(square_mm2 / within) : 0.0;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  made.median_mm = *middle;
  return made;
}

Picture finding_crop(const std::vector<Looked>& looked, ImageView<const std::uint8_t> grey, const Frame& frame) {
  Picture picture = dim(grey, frame);
  for (const Looked& one : looked) dab(picture, frame, one.row, one.col, 1, finding_colour(one.finding));
  return picture;
}

Picture cut(const Picture& whole, const Frame& frame) {
  Picture picture(frame.rows, frame.cols);
  for (int r = 0; r < frame.rows; ++r) {
    for (int c = 0; c < frame.cols; ++c) picture.view()(r, c) = whole.view()(frame.row + r, frame.col + c);
  }
  return picture;
}

}  // namespace beltpick::explain
