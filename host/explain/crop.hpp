// Crop: a part of the camera's image with something painted over it, for one object's pictures.
#pragma once

#include "contract_io/pictures.hpp"
#include "explain/story.hpp"

namespace beltpick::explain {

using contract_io::Picture;
using contract_io::Rgb;

// Green, red, blue, orange, yellow, violet: what a surface point met, by result::Finding.
Rgb finding_colour(result::Finding finding);
const char* finding_name(result::Finding finding);

// The image region round an object, as it is shown.
struct Frame {
  int row = 0, col = 0, rows = 1, cols = 1;

  // The object's box with a margin, within the image.
  static Frame round(const Segment& segment, int image_rows, int image_cols);
};

// The object's range image in colour: what was measured in the frame, near red, far blue.
Picture range_crop(const RangeImage& range, const Frame& frame);

// The objects' colours over the camera's image.
Picture label_crop(ImageView<const std::uint16_t> labels, ImageView<const std::uint8_t> grey, const Frame& frame);

// The object's measured points that lie on the primitive in green, the others in grey; a cylinder's axis in red.
struct InlierPicture {
  Picture picture;
  int on_it = 0, pixels = 0;
};
InlierPicture inlier_crop(const result::Scene& scene, const pipeline::Object& object, const Primitive& primitive,
                          ImageView<const std::uint8_t> grey, const Frame& frame);

// How far the object's measured points lie off the part's surface in a pose: blue inside, red outside, white on it,
// black beyond `scale_mm`.
struct ResidualPicture {
  Picture picture;
  double scale_mm = 1.0;
  double rms_mm = 0.0;        // of the points within the scale
  double median_mm = 0.0;     // of all, without sign
  double within_share = 0.0;  // of all, those within the scale
};
ResidualPicture residual_crop(const result::Scene& scene, const pipeline::Object& object, const PartModel& model,
                              const result::PartPose& T_camera_part, double scale_mm,
                              ImageView<const std::uint8_t> grey, const Frame& frame);

// What each surface point in sight met.
Picture finding_crop(const std::vector<Looked>& looked, ImageView<const std::uint8_t> grey, const Frame& frame);

// The region of a whole picture.
Picture cut(const Picture& whole, const Frame& frame);

}  // namespace beltpick::explain
