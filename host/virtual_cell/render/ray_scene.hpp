// RayScene: parts and belt as Embree sees them. The belt is a plane of its own; parts are instances of their meshes.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/pose.hpp"
#include "virtual_cell/render/scene_part.hpp"
#include "virtual_cell/render/scene_renderer.hpp"

namespace beltpick::virtual_cell {

inline constexpr int kHitBelt = -1;
inline constexpr int kHitNothing = -2;

// Where a ray first meets the scene. Camera frame unless the name says otherwise.
struct RayHit {
  int instance = kHitNothing;     // index into the placed instances, kHitBelt or kHitNothing
  float distance = 0.0F;          // in lengths of the ray's direction
  Vec3f normal = Vec3f::UnitZ();  // of the smooth surface, unit, outward
  Vec3f face_normal = Vec3f::UnitZ();
  Vec3f local_mm = Vec3f::Zero();  // the point in the part's frame, or in the belt's
};

class RayScene {
 public:
  RayScene(std::span<const ScenePart> parts, const Pose<frame::Camera, frame::Belt>& T_camera_belt);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  void place(std::span<const PartInstance> instances);
  [[nodiscard]] const std::vector<PartInstance>& instances() const;
  [[nodiscard]] const ScenePart& part(int index) const;

  // Thread-safe. `direction` need not be of unit length.
  [[nodiscard]] RayHit cast(const Vec3f& origin_mm, const Vec3f& direction) const;
  // Whether a part lies between a point and `direction` lengths beyond it; `direction` reaches the light.
  [[nodiscard]] bool blocked(const Vec3f& origin_mm, const Vec3f& direction) const;
  // Whether the ray meets the one instance, whatever lies before it; the distance to it.
  [[nodiscard]] bool meets(int instance, const Vec3f& direction_from_camera, float& distance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace beltpick::virtual_cell
