#include "virtual_cell/render/caster.hpp"

#include <cmath>

#include "virtual_cell/render/board_print.hpp"
#include "virtual_cell/render/pattern_light.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr float kFocusBlurPx = 0.45F;  // of the projector in focus
constexpr float kDefocusPxPerMm = 0.009F;

}  // namespace

float vignetting(const Vec3f& to_eye) { return std::pow(-to_eye.z(), 4.0F); }  // the cosine-fourth law

Caster::Caster(const Rig& rig, const RayScene& scene, const RenderOptions& options, std::uint64_t seed)
    : rig_(rig),
      scene_(scene),
      options_(options),
      seed_(static_cast<std::uint32_t>(seed * 0x9e3779b97f4a7c15ULL >> 32U)) {
  projector_centre_ = rig.T_projector_camera.inverse().translation_mm.cast<float>();
  up_ = rig.T_camera_belt.rotation.col(2).cast<float>();
  focus_mm_ = static_cast<float>((rig.T_projector_camera * rig.T_camera_belt.translation_mm).norm()) - 25.0F;
}

std::optional<Spot> Caster::meet(const Vec3f& origin_mm, const Vec3f& direction, float width) const {
  Spot spot;
  spot.hit = scene_.cast(origin_mm, direction);
  if (spot.hit.instance == kHitNothing) return std::nullopt;
  spot.point_mm = origin_mm + spot.hit.distance * direction;
  float share = 0.0F;
  if (spot.hit.instance != kHitBelt) {
    const ScenePart& part = scene_.part(scene_.instances()[spot.hit.instance].part);
    if (part.finish == Finish::kPrinted) share = ink_share(spot.hit, *part.print, direction, width);
  }
  spot.ink = share <= 0.0F ? Ink::kNone : share >= 1.0F ? Ink::kAll : Ink::kMixed;
  spot.surface = surface_at(spot.hit, share);
  return spot;
}

LightSample Caster::trace(const Vec3f& ray, float width_px) const {
  LightSample sample;
  const auto spot = meet(Vec3f::Zero(), ray, width_px / static_cast<float>(rig_.camera.fx_px));
  if (!spot) return sample;
  sample.instance = static_cast<std::int16_t>(spot->hit.instance);
  sample.distance = spot->hit.distance;
  sample.ink = spot->ink;
  const Vec3f to_eye = -ray.normalized();
  sample.ambient = scattered_ambient(spot->surface, up_) * vignetting(to_eye);
  light(*spot, to_eye, sample);
  sample.direct *= vignetting(to_eye);
  return sample;
}

LightSample Caster::look(const Vec3f& origin_mm, const Vec3f& direction) const {
  constexpr float kWidth = 0.05F;  // one of a hundred or so rays over all directions
  LightSample sample;
  const auto spot = meet(origin_mm, direction, kWidth);
  if (!spot || spot->hit.face_normal.dot(direction) >= 0.0F) return sample;
  sample.instance = static_cast<std::int16_t>(spot->hit.instance);
  sample.distance = spot->hit.distance;
  light(*spot, -direction, sample);
  return sample;
}

Surface Caster::surface_at(const RayHit& hit, float ink_share) const {
  if (hit.instance == kHitBelt) {
    return options_.background == Background::kPlane ? matt_plane_surface(hit.normal)
                                                     : belt_surface(hit.local_mm, hit.normal, seed_);
  }
  const std::uint32_t seed = seed_ + 977U * static_cast<std::uint32_t>(hit.instance + 1);
  switch (scene_.part(scene_.instances()[hit.instance].part).finish) {
    case Finish::kMattWhite:
      return painted_surface(hit.local_mm, hit.normal, seed);
    case Finish::kPrinted:
      return printed_surface(hit.local_mm, hit.normal, ink_share, seed);
    case Finish::kSteel:
      break;
  }
  return steel_surface(hit.local_mm, hit.normal, seed);
}

// The print within the ray's footprint: a square across the ray, seen on the surface as a parallelogram and taken for
// the rectangle of the same variance along the print's axes.
float Caster::ink_share(const RayHit& hit, const BoardPrint& print, const Vec3f& direction, float width) const {
  constexpr float kPrintedFaceMm = 0.5F;  // the print is on the face at z = 0 only
  if (hit.local_mm.z() > kPrintedFaceMm) return 0.0F;
  const Mat3& rotation = scene_.instances()[hit.instance].T_camera_part.rotation;
  const auto on_surface = [&](const Vec3f& step) {
    const Vec3f moved = step - direction * (hit.normal.dot(step) / hit.normal.dot(direction));
    return Vec3f(rotation.transpose().cast<float>() * moved);
  };
  const Vec3f across = on_surface({hit.distance * width, 0.0F, 0.0F});
  const Vec3f down = on_surface({0.0F, hit.distance * width, 0.0F});
  return print.ink_share(hit.local_mm.x(), hit.local_mm.y(), std::hypot(across.x(), down.x()),
                         std::hypot(across.y(), down.y()));
}

// The projector's light at the spot: its coordinates there, and how much of it goes to the eye.
void Caster::light(const Spot& spot, const Vec3f& to_eye, LightSample& sample) const {
  const Vec3 lit = rig_.T_projector_camera * spot.point_mm.cast<double>();
  if (lit.z() <= 0.0) return;
  const Eigen::Vector2d pixel = rig_.projector.project(lit);
  sample.column_px = static_cast<float>(pixel.x());
  sample.row_px = static_cast<float>(pixel.y());
  const auto range_mm = static_cast<float>(lit.norm());
  sample.blur_level = static_cast<std::uint8_t>(
      PatternLight::blur_level(std::hypot(kFocusBlurPx, kDefocusPxPerMm * (range_mm - focus_mm_))));
  const bool in_image = pixel.x() > -0.5 && pixel.x() < rig_.projector.width - 0.5 && pixel.y() > -0.5 &&
                        pixel.y() < rig_.projector.height - 0.5;
  const Vec3f off = spot.point_mm + kOffSurfaceMm * spot.hit.face_normal;
  const Vec3f to_light = projector_centre_ - off;
  if (!in_image || spot.hit.face_normal.dot(to_light) <= 0.0F || scene_.blocked(off, to_light)) return;
  const auto cosine = static_cast<float>(lit.z()) / range_mm;
  const float falloff = focus_mm_ * focus_mm_ / (range_mm * range_mm) * cosine * cosine * cosine;
  sample.direct = falloff * scattered(spot.surface, to_light.normalized(), to_eye);
}

}  // namespace beltpick::virtual_cell
