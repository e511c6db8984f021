#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "support/shapes.hpp"
#include "teach/neighbours.hpp"
#include "teach/surface.hpp"

using namespace beltpick;

TEST_CASE("points are spread evenly: none close together, no face bare", "[teach]") {
  Mesh mesh = test::box(60, 40, 20);
  teach::repair(mesh);
  const auto surface = teach::sample_mesh(mesh, 4000, 7);
  REQUIRE(surface.has_value());
  CHECK(surface->area_mm2 == Approx(2 * (60 * 40 + 60 * 20 + 40 * 20)));
  CHECK(surface->point_mm.size() > 3800);
  std::array<int, 6> on_face{};
  for (std::size_t i = 0; i < surface->point_mm.size(); ++i) {
    const Vec3f& n = surface->normal[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (n[axis] > 0.9F) ++on_face[2 * axis];
      if (n[axis] < -0.9F) ++on_face[2 * axis + 1];
    }
  }
  const double per_mm2 = static_cast<double>(surface->point_mm.size()) / surface->area_mm2;
  CHECK(on_face[0] == Approx(40 * 20 * per_mm2).epsilon(0.1));
  CHECK(on_face[5] == Approx(60 * 40 * per_mm2).epsilon(0.1));
  // Slow and obvious: every pair on one face.
  float closest = 1e9F;
  for (std::size_t i = 0; i < 800; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (surface->normal[i].dot(surface->normal[j]) > 0.0F) {
        closest = std::min(closest, (surface->point_mm[i] - surface->point_mm[j]).norm());
      }
    }
  }
  CHECK(closest > 0.7 * surface->spacing_mm);
}

TEST_CASE("faces turned inward are turned outward, duplicates go, holes are told", "[teach]") {
  Mesh mesh = test::box(10, 10, 10);
  mesh.face.push_back(mesh.face.front());
  for (const std::size_t f : {1UL, 5UL, 7UL}) std::swap(mesh.face[f][1], mesh.face[f][2]);
  const auto report = teach::repair(mesh);
  CHECK(report.duplicate_faces == 1);
  CHECK(report.flipped_faces == 3);
  CHECK(report.open_edges == 0);
  const Vec3f middle(5, 5, 5);
  for (const auto& face : mesh.face) {
    const Vec3f a = mesh.vertex_mm[face[0]];
    const Vec3f normal = (mesh.vertex_mm[face[1]] - a).cross(mesh.vertex_mm[face[2]] - a);
    CHECK(normal.dot(a - middle) > 0);
  }
  mesh.face.pop_back();
  CHECK(teach::repair(mesh).open_edges == 3);
}

TEST_CASE("a mesh wholly inside out is turned outward", "[teach]") {
  Mesh mesh = test::bracket();
  for (auto& face : mesh.face) std::swap(face[1], face[2]);
  CHECK(teach::repair(mesh).flipped_faces > mesh.face.size() / 2);
}

TEST_CASE("a scan without normals gets those of its surface", "[teach]") {
  Mesh dense = test::bracket();
  teach::repair(dense);
  const auto truth = teach::sample_mesh(dense, 20000, 3);
  Mesh scan;
  for (const Vec3f& p : truth->point_mm) {
    if (p.z() > 7.99F && p.x() > 15) scan.vertex_mm.push_back(p);  // the plate's upper side and the boss
  }
  const auto surface = teach::sample_scan(scan, 3000, 1);
  REQUIRE(surface.has_value());
  CHECK(surface->point_mm.size() <= 3000);
  CHECK(surface->point_mm.size() > 1500);
  int upright = 0;
  int plate = 0;
  for (std::size_t i = 0; i < surface->point_mm.size(); ++i) {
    const Vec3f& p = surface->point_mm[i];
    if (p.z() > 8.01F || (p - Vec3f(62, 20, 8)).norm() < 16 || p.x() < 18 || p.x() > 87 || p.y() < 3 || p.y() > 47)
      continue;
    ++plate;
    if (std::abs(surface->normal[i].z()) > 0.99F) ++upright;
  }
  CHECK(plate > 500);
  CHECK(upright > 0.99 * plate);
}

TEST_CASE("the neighbour index agrees with looking at every point", "[teach]") {
  Random random(5);
  std::vector<Vec3f> points(500);
  for (Vec3f& p : points) p = Vec3(random.uniform(), random.uniform(), random.uniform()).cast<float>();
  const teach::NeighbourIndex index(points);
  for (int k = 0; k < 50; ++k) {
    const Vec3f query = Vec3(random.uniform(), random.uniform(), random.uniform()).cast<float>();
    std::array<teach::Neighbour, 1> near;
    index.nearest(query, near);
    float least = 1e9F;
    for (const Vec3f& p : points) least = std::min(least, (p - query).squaredNorm());
    CHECK(near[0].squared_mm2 == Approx(least));
  }
}
