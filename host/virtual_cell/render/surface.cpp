#include "virtual_cell/render/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace beltpick::virtual_cell {
namespace {

constexpr float kPiF = std::numbers::pi_v<float>;

// An integer hash (the finaliser of Murmur 3) of a lattice point.
float lattice(int x, int y, int z, std::uint32_t seed) {
  std::uint32_t h = seed;
  for (const int v : {x, y, z}) {
    h ^= static_cast<std::uint32_t>(v) * 0x9e3779b1U;
    h = (h ^ (h >> 16U)) * 0x85ebca6bU;
    h = (h ^ (h >> 13U)) * 0xc2b2ae35U;
    h ^= h >> 16U;
  }
  return static_cast<float>(h) * (2.0F / 4294967296.0F) - 1.0F;
}

float ease(float t) { return t * t * (3.0F - 2.0F * t); }
float mix(float a, float b, float t) { return a + t * (b - a); }
float step_between(float low, float high, float x) { return ease(std::clamp((x - low) / (high - low), 0.0F, 1.0F)); }

// Relief finer than the mesh: tilts the normal by about `amount` radians.
Vec3f roughened(const Vec3f& normal, const Vec3f& at, float amount, std::uint32_t seed) {
  const Vec3f tilt(smooth_noise(at, seed), smooth_noise(at, seed + 1U), smooth_noise(at, seed + 2U));
  return (normal + amount * tilt).normalized();
}

}  // namespace

float smooth_noise(const Vec3f& point, std::uint32_t seed) {
  const Vec3f base(std::floor(point.x()), std::floor(point.y()), std::floor(point.z()));
  const int x = static_cast<int>(base.x());
  const int y = static_cast<int>(base.y());
  const int z = static_cast<int>(base.z());
  const Vec3f f = point - base;
  const float u = ease(f.x());
  const float v = ease(f.y());
  const float w = ease(f.z());
  const auto along_x = [&](int j, int k) {
    return mix(lattice(x, y + j, z + k, seed), lattice(x + 1, y + j, z + k, seed), u);
  };
  return mix(mix(along_x(0, 0), along_x(1, 0), v), mix(along_x(0, 1), along_x(1, 1), v), w);
}

Surface steel_surface(const Vec3f& local_mm, const Vec3f& normal, std::uint32_t seed) {
  const float grain = smooth_noise(local_mm / 0.8F, seed);
  const float stain = smooth_noise(local_mm / 7.0F, seed + 11U);
  const float oil = step_between(0.28F, 0.42F, smooth_noise(local_mm / 24.0F, seed + 23U));
  Surface s;
  s.diffuse = 0.26F * (1.0F + 0.14F * grain + 0.18F * stain) * (1.0F - 0.40F * oil);
  s.specular = 0.22F * (1.0F + 0.15F * stain) * (1.0F - 0.45F * oil);
  s.roughness = mix(0.52F + 0.05F * stain, 0.32F, oil);
  s.normal = roughened(normal, local_mm / 1.3F, mix(0.09F, 0.03F, oil), seed + 37U);
  return s;
}

Surface belt_surface(const Vec3f& belt_mm, const Vec3f& normal, std::uint32_t seed) {
  const Vec3f flat(belt_mm.x(), belt_mm.y(), 0.0F);
  const float weave = std::sin(belt_mm.x() * 2.9F) * std::sin(belt_mm.y() * 2.9F);
  const float dirt = smooth_noise(flat / 18.0F, seed);
  Surface s;
  s.diffuse = 0.10F * (1.0F + 0.12F * weave + 0.10F * smooth_noise(flat / 0.9F, seed + 5U) + 0.22F * dirt);
  s.specular = 0.02F;
  s.roughness = 0.7F;
  s.normal = normal;
  return s;
}

Surface matt_plane_surface(const Vec3f& normal) {
  Surface s;
  s.diffuse = 0.6F;
  s.normal = normal;
  return s;
}

Surface painted_surface(const Vec3f& local_mm, const Vec3f& normal, std::uint32_t seed) {
  Surface s;
  s.diffuse =
      0.78F * (1.0F + 0.008F * smooth_noise(local_mm / 0.7F, seed) + 0.012F * smooth_noise(local_mm / 30.0F, seed));
  s.normal = normal;
  return s;
}

Surface printed_surface(const Vec3f& local_mm, const Vec3f& normal, float ink_share, std::uint32_t seed) {
  constexpr float kInk = 0.06F;  // laser print on matt foil reflects 5 to 8 %
  Surface s = painted_surface(local_mm, normal, seed);
  s.diffuse = mix(s.diffuse, kInk * (1.0F + 0.06F * smooth_noise(local_mm / 0.9F, seed + 3U)), ink_share);
  s.specular = 0.03F;
  s.roughness = 0.5F;
  return s;
}

float scattered(const Surface& surface, const Vec3f& to_light, const Vec3f& to_eye) {
  const float nl = surface.normal.dot(to_light);
  const float nv = surface.normal.dot(to_eye);
  if (nl <= 0.0F) return 0.0F;
  const float matt = surface.diffuse / kPiF;
  if (nv <= 1e-3F || surface.specular <= 0.0F) return matt * nl;
  const Vec3f half = (to_light + to_eye).normalized();
  const float a2 = surface.roughness * surface.roughness;
  const float nh = surface.normal.dot(half);
  const float bell = nh * nh * (a2 - 1.0F) + 1.0F;
  const float facets = a2 / (kPiF * bell * bell);
  const auto smith = [a2](float cosine) {
    return 2.0F * cosine / (cosine + std::sqrt(a2 + (1.0F - a2) * cosine * cosine));
  };
  const float fresnel = surface.specular + (1.0F - surface.specular) * std::pow(1.0F - half.dot(to_eye), 5.0F);
  return (matt + fresnel * facets * smith(nl) * smith(nv) / (4.0F * nl * nv)) * nl;
}

float scattered_ambient(const Surface& surface, const Vec3f& up) {
  return (surface.diffuse + 0.5F * surface.specular) / kPiF * (0.65F + 0.35F * surface.normal.dot(up));
}

}  // namespace beltpick::virtual_cell
