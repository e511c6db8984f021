#include <catch2/catch.hpp>

#include "support/shapes.hpp"
#include "teach/cones.hpp"
#include "teach/recognition.hpp"
#include "teach/teach.hpp"

using namespace beltpick;

namespace {

// A frustum along z, closed: radius 20 at z = 0, 10 at z = 30.
Mesh frustum() {
  Mesh mesh;
  constexpr int kSides = 120;
  const auto rim = [](double radius, double z, int k) {
    const double angle = 2 * kPi * k / kSides;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  for (int k = 0; k < kSides; ++k) {
    test::add_quad(mesh, rim(20, 0, k), rim(20, 0, k + 1), rim(10, 30, k + 1), rim(10, 30, k));
    test::add_quad(mesh, Vec3(0, 0, 30), rim(10, 30, k), rim(10, 30, k + 1), Vec3(0, 0, 30));
    test::add_quad(mesh, Vec3(0, 0, 0), rim(20, 0, k + 1), rim(20, 0, k), Vec3(0, 0, 0));
  }
  return mesh;
}

}  // namespace

TEST_CASE("a frustum's cone is found: apex, axis, angle and extent", "[teach][cones]") {
  Mesh mesh = frustum();
  teach::repair(mesh);
  const auto surface = teach::sample_mesh(mesh, 12000, 5);
  REQUIRE(surface.has_value());
  auto primitives = teach::find_primitives(*surface, 1);
  const auto cones = teach::find_cones(*surface, primitives, 1);
  REQUIRE(cones.size() == 1);
  // The spheres and cylinders that touch it along a ring are none.
  for (const Primitive& primitive : primitives) CHECK(primitive.kind == PrimitiveKind::kPlane);
  const TaughtCone& cone = cones.front();
  CHECK((cone.apex_mm - Vec3(0, 0, 60)).norm() < 0.5);
  CHECK(cone.direction.z() < -0.9995);
  CHECK(cone.half_angle_rad == Approx(std::atan2(10.0, 30.0)).margin(0.01));
  CHECK(cone.from_mm == Approx(30).margin(2));
  CHECK(cone.to_mm == Approx(60).margin(2));
  CHECK_FALSE(cone.concave);
  // Turned inside out it is a countersink.
  teach::Surface inside = *surface;
  for (Vec3f& normal : inside.normal) normal = -normal;
  std::vector<Primitive> none;
  const auto sinks = teach::find_cones(inside, none, 1);
  REQUIRE(sinks.size() >= 1);
  CHECK(sinks.front().concave);
}

TEST_CASE("a bracket has no cones", "[teach][cones]") {
  const auto taught = teach::teach(test::bracket(), {}, {.points = 8000});
  REQUIRE(taught.has_value());
  CHECK(taught->part.cones.empty());
}

TEST_CASE("what lies behind the part itself is not seen", "[teach][recognition]") {
  Mesh mesh = test::box(60, 40, 20);
  teach::repair(mesh);
  const auto surface = teach::sample_mesh(mesh, 6000, 5);
  const auto seen = teach::seen_along(*surface, {0, 0, -1});
  int top = 0, top_seen = 0, others_seen = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool on_top = surface->normal[i].z() > 0.9F;
    top += on_top ? 1 : 0;
    top_seen += on_top && seen[i] ? 1 : 0;
    others_seen += !on_top && seen[i] ? 1 : 0;
  }
  CHECK(top_seen == top);
  CHECK(others_seen == 0);
}

TEST_CASE("routes are planned from what is seen, and one needs no primitive", "[teach][recognition]") {
  const auto taught = teach::teach(test::bracket(), {}, {.points = 8000});
  REQUIRE(taught.has_value());
  const PartTemplate& part = taught->part;
  REQUIRE(taught->worth.size() == part.primitives.size());
  for (std::size_t i = 1; i < taught->worth.size(); ++i) {
    CHECK(taught->worth[i - 1].usefulness >= taught->worth[i].usefulness);
  }
  const auto without = std::count_if(part.routes.begin(), part.routes.end(),
                                     [](const RecognitionRoute& route) { return route.primitive < 0; });
  CHECK(without == 1);
  CHECK(part.routes.size() >= 3);
  for (const RecognitionRoute& route : part.routes) {
    CHECK(route.poses > 0);
    CHECK(route.visible <= 1.0);
  }
}
