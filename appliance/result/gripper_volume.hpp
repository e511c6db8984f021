// GripperVolume: the room that the open gripper sweeps on its way to a grasp, in the gripper's frame.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/pose.hpp"
#include "contract/gripper.hpp"

namespace beltpick::result {

class GripperVolume {
 public:
  // `clearance_mm`: added on all sides.
  GripperVolume(const GripperShape& shape, double opening_mm, double clearance_mm)
      : inner_mm_(static_cast<float>(0.5 * opening_mm - clearance_mm)),
        outer_mm_(static_cast<float>(0.5 * opening_mm + shape.jaw_thickness_mm + clearance_mm)),
        half_width_mm_(static_cast<float>(0.5 * shape.jaw_width_mm + clearance_mm)),
        tip_mm_(static_cast<float>(shape.tip_mm + clearance_mm)),
        back_mm_(static_cast<float>(-shape.reach_mm)),
        palm_mm_(static_cast<float>(shape.tip_mm - shape.jaw_depth_mm + clearance_mm)) {
    if (shape.palm_length_mm <= 0.0 || shape.palm_width_mm <= 0.0) return;
    palm_half_length_mm_ = static_cast<float>(0.5 * shape.palm_length_mm + clearance_mm);
    palm_half_width_mm_ = static_cast<float>(0.5 * shape.palm_width_mm + clearance_mm);
  }

  [[nodiscard]] bool holds(const Vec3f& at_mm) const {
    const float x = std::abs(at_mm.x()), y = std::abs(at_mm.y()), z = at_mm.z();
    if (z <= back_mm_ || z >= tip_mm_) return false;
    if (z < palm_mm_ && x < palm_half_length_mm_ && y < palm_half_width_mm_) return true;
    return x > inner_mm_ && x < outer_mm_ && y < half_width_mm_;
  }

  // The corners of the boxes round both jaws and round the palm.
  [[nodiscard]] std::array<Vec3, 16> corners() const {
    std::array<Vec3, 16> at;
    for (std::size_t i = 0; i < 8; ++i) {
      const double x = (i & 1U) != 0 ? 1.0 : -1.0, y = (i & 2U) != 0 ? 1.0 : -1.0;
      const bool front = (i & 4U) != 0;
      at[i] = {x * outer_mm_, y * half_width_mm_, front ? tip_mm_ : back_mm_};
      at[i + 8] = {x * palm_half_length_mm_, y * palm_half_width_mm_, front ? palm_mm_ : back_mm_};
    }
    return at;
  }

  // A lower bound of how far a place is from the volume.
  [[nodiscard]] double distance_mm(const Vec3& at_mm) const {
    const Vec3 outside(std::max(0.0, std::abs(at_mm.x()) - std::max(outer_mm_, palm_half_length_mm_)),
                       std::max(0.0, std::abs(at_mm.y()) - std::max(half_width_mm_, palm_half_width_mm_)),
                       std::max({0.0, at_mm.z() - tip_mm_, back_mm_ - at_mm.z()}));
    return outside.norm();
  }

 private:
  float inner_mm_, outer_mm_, half_width_mm_, tip_mm_, back_mm_, palm_mm_;
  float palm_half_length_mm_ = 0.0F, palm_half_width_mm_ = 0.0F;
};

}  // namespace beltpick::result
