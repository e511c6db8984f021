// Small closed meshes with known geometry, for tests: outward faces, millimetres.
#pragma once

#include <cmath>

#include "base/units.hpp"
#include "contract/mesh.hpp"

namespace beltpick::test {

inline void add_quad(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto first = static_cast<std::uint32_t>(mesh.vertex_mm.size());
  for (const Vec3& v : {a, b, c, d}) mesh.vertex_mm.push_back(v.cast<float>());
  mesh.face.push_back({first, first + 1, first + 2});
  mesh.face.push_back({first, first + 2, first + 3});
}

inline void add_box(Mesh& mesh, const Vec3& low, const Vec3& high) {
  const auto at = [&](int x, int y, int z) {
    return Vec3(x ? high.x() : low.x(), y ? high.y() : low.y(), z ? high.z() : low.z());
  };
  add_quad(mesh, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
  add_quad(mesh, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  add_quad(mesh, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  add_quad(mesh, at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
  add_quad(mesh, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
  add_quad(mesh, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
}

inline Mesh box(double x_mm, double y_mm, double z_mm) {
  Mesh mesh;
  add_box(mesh, Vec3::Zero(), {x_mm, y_mm, z_mm});
  return mesh;
}

// A closed cylinder along z from `base_mm`, of `sides` facets.
inline void add_cylinder(Mesh& mesh, const Vec3& base_mm, double radius_mm, double length_mm, int sides = 96) {
  const Vec3 up(0, 0, length_mm);
  const auto rim = [&](int k) {
    const double angle = 2 * kPi * k / sides;
    return Vec3(base_mm + radius_mm * Vec3(std::cos(angle), std::sin(angle), 0));
  };
  for (int k = 0; k < sides; ++k) {
    add_quad(mesh, rim(k), rim(k + 1), rim(k + 1) + up, rim(k) + up);
    add_quad(mesh, base_mm, rim(k + 1), rim(k), rim(k));
    add_quad(mesh, base_mm + up, rim(k) + up, rim(k + 1) + up, rim(k + 1) + up);
  }
  std::erase_if(mesh.face, [&](const auto& f) {
    const Vec3f a = mesh.vertex_mm[f[1]] - mesh.vertex_mm[f[0]];
    return a.cross(Vec3f(mesh.vertex_mm[f[2]] - mesh.vertex_mm[f[0]])).squaredNorm() == 0.0F;
  });
}

// Without any symmetry: an angle with a boss off its middle. Its box starts at the origin.
inline Mesh bracket() {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {90, 50, 8});
  add_box(mesh, {0, 0, 8}, {8, 50, 45});
  add_cylinder(mesh, {62, 20, 8}, 12, 22);
  return mesh;
}

}  // namespace beltpick::test
