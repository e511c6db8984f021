// ShadowMap: how far the projector's light came in each direction, by what was measured. What lies clearly beyond is in
// a cast shadow, a neighbour's or the part's own, and cannot have been measured: that it is missing tells nothing.
//
// The side that an object turns to the light may be one that the camera does not see: where a measured surface ends, it
// is taken to reach down to the belt.
#pragma once

#include <optional>

#include "base/arena.hpp"
#include "base/point_block.hpp"
#include "base/stages.hpp"
#include "contract/limits.hpp"
#include "contract/part_model.hpp"

namespace beltpick::result {

class ShadowMap {
 public:
  ShadowMap(Arena& arena, const Limits& limits);

  // Casts the light from `light_mm` (camera frame) on the measured points; without a light nothing is in shadow, and
  // without a belt no surface reaches down.
  void cast(const RangeImage& range, const std::optional<Vec3>& light_mm, const std::optional<Plane>& belt);

  // Casts the light on a part that is known to lie there, too: on all of it, of which the camera sees one side.
  void add(const PartModel& model, const Pose<frame::Camera, frame::Part>& T_camera_part);

  // Whether something was measured on the way from the light to a surface point with this normal (camera frame), more
  // than `margin_mm` before it.
  [[nodiscard]] bool hides(const Vec3f& point_mm, const Vec3f& normal, float margin_mm) const;

 private:
  struct Cell {
    int row = -1, col = -1;
    float distance_mm = 0.0F;  // from the light
  };
  void aim(const RangeImage& range);
  [[nodiscard]] Cell look(const Vec3f& point_mm) const;
  void stop_light(const Vec3f& point_mm);
  void stop_light(PointBlock& points, int count);
  void stop_at_sides(const RangeImage& range, const Plane& belt);
  void bridge_gaps();

  std::span<float> memory_, bridged_;
  ImageView<float> lit_mm_;  // distance from the light to the nearest measured point of a cell; 0: none
  std::optional<Vec3f> light_mm_;
  Vec3f middle_mm_ = Vec3f::Zero();                               // of what was measured
  Eigen::Matrix3f R_light_camera_ = Eigen::Matrix3f::Identity();  // z towards the middle of what was measured
  float tan_left_ = 0.0F, tan_top_ = 0.0F, cells_per_tan_ = 1.0F;
};

}  // namespace beltpick::result
