// How surfaces of the virtual cell scatter light: rough cast steel with oil film, and a dark matt belt.
#pragma once

#include <cstdint>

#include "base/pose.hpp"

namespace beltpick::virtual_cell {

struct Surface {
  float diffuse = 0.0F;    // albedo of the matt share
  float specular = 0.0F;   // reflectance of the microfacets at normal incidence
  float roughness = 0.5F;  // GGX alpha
  Vec3f normal = Vec3f::UnitZ();
};

// Smooth noise in [-1, 1] with a correlation length of one unit; the same for the same arguments.
float smooth_noise(const Vec3f& point, std::uint32_t seed);

// Cast steel at a point of the part (its own frame, mm), with the geometric normal in any frame. Grain, stains, fine
// relief and patches of oil follow from `seed`.
Surface steel_surface(const Vec3f& local_mm, const Vec3f& normal, std::uint32_t seed);
// The belt's woven cover at a point of the belt frame; the even plane for the noise figure.
Surface belt_surface(const Vec3f& belt_mm, const Vec3f& normal, std::uint32_t seed);
Surface matt_plane_surface(const Vec3f& normal);

// White paint, slightly uneven, at a point of the part (its own frame, mm).
Surface painted_surface(const Vec3f& local_mm, const Vec3f& normal, std::uint32_t seed);
// The same with `ink_share` of it printed: ink is dark, not black, and a little glossy.
Surface printed_surface(const Vec3f& local_mm, const Vec3f& normal, float ink_share, std::uint32_t seed);

// Light scattered towards `to_eye` per light arriving from `to_light` (unit vectors), cosine included: Lambert plus
// GGX microfacets (Walter et al. 2007) with Smith's shadowing and Schlick's Fresnel term.
float scattered(const Surface& surface, const Vec3f& to_light, const Vec3f& to_eye);

// The same for even ambient light from above.
float scattered_ambient(const Surface& surface, const Vec3f& up);

}  // namespace beltpick::virtual_cell
