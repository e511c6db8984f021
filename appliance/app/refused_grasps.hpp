// RefusedGrasps: the grasps with which a pick failed at this stop of the belt, so that none is offered twice: what was
// in the gripper's way may be hidden from the camera. Written by the controller, read by the vision thread.
#pragma once

#include <algorithm>
#include <array>
#include <mutex>
#include <span>

#include "base/pose.hpp"

namespace beltpick::app {

class RefusedGrasps {
 public:
  using GripperPose = Pose<frame::Camera, frame::Gripper>;
  static constexpr std::size_t kMost = 16;

  // Beyond kMost the oldest is forgotten.
  void add(const GripperPose& T_camera_gripper) {
    const std::lock_guard lock(mutex_);
    poses_[next_++ % kMost] = T_camera_gripper;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    next_ = 0;
  }
  // Copies them to `out`, and returns what was written.
  std::span<const GripperPose> copy(std::array<GripperPose, kMost>& out) const {
    const std::lock_guard lock(mutex_);
    out = poses_;
    return {out.data(), std::min(next_, kMost)};
  }

 private:
  mutable std::mutex mutex_;
  std::array<GripperPose, kMost> poses_{};
  std::size_t next_ = 0;
};

}  // namespace beltpick::app
