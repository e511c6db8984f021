// Caster: what a ray through a placed scene brings back: the surface it meets and the projector's light from there.
#pragma once

#include <cstdint>
#include <optional>

#include "virtual_cell/render/ray_scene.hpp"
#include "virtual_cell/render/rig.hpp"
#include "virtual_cell/render/scene_renderer.hpp"
#include "virtual_cell/render/surface.hpp"

namespace beltpick::virtual_cell {

class BoardPrint;

// How much of a pixel is printed.
enum class Ink : std::uint8_t { kNone, kAll, kMixed };

// What one ray brings back.
struct LightSample {
  float column_px = 0.0F, row_px = 0.0F;  // in the projector's image
  float direct = 0.0F;                    // radiance per white projector light; 0 in shadow
  float ambient = 0.0F;                   // radiance per ambient light
  float distance = 0.0F;                  // along the ray (a pixel's: camera z, mm)
  std::int16_t instance = kHitNothing;
  std::uint8_t blur_level = 0;
  Ink ink = Ink::kNone;
};

// Where a ray ends.
struct Spot {
  RayHit hit;
  Vec3f point_mm = Vec3f::Zero();
  Surface surface;
  Ink ink = Ink::kNone;
};

// Thread-safe. Keeps references to all it is given.
class Caster {
 public:
  static constexpr float kOffSurfaceMm = 0.05F;  // off the facets, which stand proud of the smooth surface

  Caster(const Rig& rig, const RayScene& scene, const RenderOptions& options, std::uint64_t seed);

  // The first surface from `origin` along `direction` (camera frame). `width`: what the ray stands for, in lengths of
  // its direction at distance 1.
  [[nodiscard]] std::optional<Spot> meet(const Vec3f& origin_mm, const Vec3f& direction, float width) const;
  // What the camera gets through a ray from its centre, with z = 1.
  [[nodiscard]] LightSample trace(const Vec3f& ray, float width_px) const;
  // The projector's light that the first surface along a unit direction sends back to `origin`.
  [[nodiscard]] LightSample look(const Vec3f& origin_mm, const Vec3f& direction) const;

 private:
  [[nodiscard]] Surface surface_at(const RayHit& hit, float ink_share) const;
  [[nodiscard]] float ink_share(const RayHit& hit, const BoardPrint& print, const Vec3f& direction, float width) const;
  void light(const Spot& spot, const Vec3f& to_eye, LightSample& sample) const;

  const Rig& rig_;
  const RayScene& scene_;
  const RenderOptions& options_;
  std::uint32_t seed_;
  Vec3f projector_centre_, up_;
  float focus_mm_;
};

// Light that the camera's lens takes from a direction towards it, against the middle of its image.
float vignetting(const Vec3f& to_eye);

}  // namespace beltpick::virtual_cell
