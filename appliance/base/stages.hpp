// The data that flows from stage to stage. Each stage takes and returns these; none knows the others.
//
// All images of a capture have the camera's size. Memory belongs to the pipeline's arena; these are views of it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/camera_noise.hpp"
#include "base/image.hpp"
#include "base/pose.hpp"

namespace beltpick {

// Why a pixel has no projector coordinate (or that it has one).
enum class PixelState : std::uint8_t {
  kValid = 0,
  kDark,            // too little of the projector's light
  kSaturated,       // a fringe exceeds the camera's range
  kLowModulation,   // light, but no fringe that stands out of the noise
  kOrderUncertain,  // which fringe it is cannot be told, or the frames contradict each other
  kEdge,            // mixes two depths, or ends a surface half covered
  kMoved            // the pattern shown again at the end of the sequence looks different here than at its start
};
// How files and messages call them, in the order of the enumerators.
inline constexpr std::array<std::string_view, 7> kPixelStateNames{
    "valid", "dark", "saturated", "low_modulation", "order_uncertain", "edge", "moved"};

// Pixels by PixelState.
using PixelCounts = std::array<int, kPixelStateNames.size()>;
inline PixelCounts count_pixels(ImageView<const PixelState> states) {
  PixelCounts counts{};
  for (std::size_t i = 0; i < states.size(); ++i) ++counts[static_cast<std::size_t>(states.data[i])];
  return counts;
}

// How uncertain a projector coordinate is: sigma_px^2 = floor_px^2 + (slope_px * sigma_I / modulation)^2, sigma_I the
// noise of one grey level (base/camera_noise.hpp). Phase: slope = sqrt(2 / N) period / 2 pi; Gray cells: floor =
// cell / sqrt(12).
struct CodeNoise {
  float floor_px = 0.0F;
  float slope_px = 0.0F;

  // Of a pixel whose white shows `texture`: the mean of its fringe is half of it.
  [[nodiscard]] float sigma_px(float modulation, std::uint8_t texture) const {
    const float amplitude = modulation > 1e-3F ? modulation : 1e-3F;
    const float level_variance = kCameraNoise.variance(0.5F * static_cast<float>(texture));
    return std::sqrt(floor_px * floor_px + slope_px * slope_px * level_variance / (amplitude * amplitude));
  }
};

// decode -> range. Absolute projector coordinates; NaN where not measured or not coded.
struct CodeImage {
  ImageView<float> column_px;       // pixel centres at integers; empty view when the sequence does not code columns
  ImageView<float> row_px;          // empty view when the sequence does not code rows
  ImageView<float> modulation;      // amplitude of the fringe in grey levels of an 8-bit camera; higher is better
  ImageView<std::uint8_t> texture;  // the scene as under white light, 8 bit
  ImageView<PixelState> state;
  CodeNoise column_noise;
  CodeNoise row_noise;
};

// range -> segment and after. Camera frame, mm; z = 0 marks "not measured" (no measurement is NaN, nor is a gap).
struct RangeImage {
  ImageView<Vec3f> point_mm;        // ordered, (row, column)
  ImageView<float> sigma_mm;        // predicted standard deviation along the ray; empty view for foreign clouds
  ImageView<std::uint8_t> texture;  // empty view for foreign clouds

  [[nodiscard]] bool valid(int row, int col) const { return point_mm(row, col).z() > 0.0F; }
};

// A plane: points x with normal . x = offset_mm, in the camera frame; the normal points to the camera (z < 0).
struct Plane {
  Vec3 normal = -Vec3::UnitZ();
  double offset_mm = 0.0;

  // Height above the plane, positive towards the camera.
  [[nodiscard]] double height_mm(const Vec3& point_mm) const { return normal.dot(point_mm) - offset_mm; }
};

// segment -> primitives. One object: the pixels of `labels` that hold `label`.
struct Segment {
  std::uint16_t label = 0;                                 // 1.. ; 0 is the belt or nothing
  int row_min = 0, row_max = 0, col_min = 0, col_max = 0;  // inclusive
  int pixels = 0;
  float top_mm = 0.0F;          // greatest height above the belt
  bool touches_border = false;  // of the image: part of the object may be out of view
};

// A measured point with its surface normal (towards the camera), camera frame.
struct OrientedPoint {
  Vec3f point_mm;
  Vec3f normal;
};

enum class PrimitiveKind : std::uint8_t { kPlane, kCylinder, kSphere };

// A primitive found in an object (camera frame) or taught with a part (part frame).
struct Primitive {
  PrimitiveKind kind = PrimitiveKind::kPlane;
  Vec3 point_mm = Vec3::Zero();    // on the plane; on the axis, midway along what is seen; the centre
  Vec3 direction = Vec3::UnitZ();  // outward normal; axis (sign free); unused for a sphere
  double radius_mm = 0.0;          // 0 for a plane
  double extent_mm = 0.0;          // length along the axis of what is seen; 0 otherwise
  bool concave = false;            // a bore rather than a boss
  double inlier_share = 0.0;       // of the object's points (or of the part's surface)
  double rms_mm = 0.0;             // of the inliers
};

// search -> icp. A rough pose and the mean distance Q that ranks it.
struct Hypothesis {
  Pose<frame::Camera, frame::Part> T_camera_part;
  float mean_distance_mm = 0.0F;
};

// icp -> result.
struct Alignment {
  Pose<frame::Camera, frame::Part> T_camera_part;
  double rms_mm = 0.0;                                                           // of the inliers, to the surface
  double inlier_share = 0.0;                                                     // of the object's sample
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  // rotation (rad), translation (mm)
  int iterations = 0;
};

}  // namespace beltpick
