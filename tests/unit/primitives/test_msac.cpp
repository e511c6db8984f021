// MSAC against primitives that are known because the points were made from them.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/units.hpp"
#include "primitives/cost.hpp"
#include "primitives/msac.hpp"

using namespace beltpick;
using primitives::Finder;
using primitives::PrimitiveQuery;
using primitives::Side;

namespace {

constexpr int kMaxPoints = 6000;

// Memory and a finder over it.
struct Bench {
  static std::size_t bytes() {
    Arena measuring;
    const Finder finder(measuring, kMaxPoints);
    return measuring.used_bytes() + 64;
  }
  ArenaBlock block{bytes()};
  Arena arena{block.data(), block.bytes()};
  Finder finder{arena, kMaxPoints};
};

double gauss(Random& random) {
  return std::sqrt(-2 * std::log(1 - random.uniform())) * std::cos(2 * kPi * random.uniform());
}

Vec3 gauss3(Random& random) { return {gauss(random), gauss(random), gauss(random)}; }

struct Cylinder {
  Vec3 point_mm{20, -10, 700};
  Vec3 axis = Vec3(0.8, 0.5, 0.2).normalized();
  double radius_mm = 15, length_mm = 60;
};

// Points of an arc about the axis that faces the camera; `side` -1 makes a bore, seen from within.
void add_cylinder(std::vector<OrientedPoint>& points, const Cylinder& c, int count, double arc_rad, double side,
                  double sigma_mm, Random& random) {
  const Vec3 up = (-c.point_mm + c.point_mm.dot(c.axis) * c.axis).normalized() * side, across = c.axis.cross(up);
  for (int i = 0; i < count; ++i) {
    const double angle = arc_rad * (random.uniform() - 0.5);
    const Vec3 outward = std::cos(angle) * up + std::sin(angle) * across;
    const Vec3 p = c.point_mm + c.length_mm * (random.uniform() - 0.5) * c.axis +
                   (c.radius_mm + sigma_mm * gauss(random)) * outward;
    const Vec3 n = (side * outward + 0.05 * gauss3(random)).normalized();
    points.push_back({p.cast<float>(), n.cast<float>()});
  }
}

void add_plane(std::vector<OrientedPoint>& points, const Vec3& at, const Vec3& normal, double size_mm, int count,
               double sigma_mm, Random& random) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  for (int i = 0; i < count; ++i) {
    const Vec3 p = at + size_mm * (random.uniform() - 0.5) * u + size_mm * (random.uniform() - 0.5) * v +
                   sigma_mm * gauss(random) * normal;
    points.push_back({p.cast<float>(), (normal + 0.05 * gauss3(random)).normalized().cast<float>()});
  }
}

void add_clutter(std::vector<OrientedPoint>& points, int count, Random& random) {
  for (int i = 0; i < count; ++i) {
    const Vec3 p = Vec3(20, -10, 700) + 40 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    points.push_back({p.cast<float>(), gauss3(random).normalized().cast<float>()});
  }
}

double axis_error_deg(const Vec3& a, const Vec3& b) {
  return deg_from_rad(std::asin(std::min(1.0, a.cross(b).norm())));
}

double off_axis_mm(const Primitive& found, const Cylinder& truth) {
  return (found.point_mm - truth.point_mm).cross(truth.axis).norm();
}

}  // namespace

TEST_CASE("a cylinder among as many outliers is found, boss and bore, 120 degrees of it", "[primitives]") {
  Bench bench;
  const Cylinder truth;
  const bool known_radius = GENERATE(true, false);
  const bool use_normals = GENERATE(true, false);
  const double side = GENERATE(1.0, -1.0);
  CAPTURE(known_radius, use_normals, side);
  Random random(7);
  std::vector<OrientedPoint> points;
  add_cylinder(points, truth, 1200, rad_from_deg(120), side, 0.05, random);
  add_plane(points, {20, -10, 730}, Vec3(0.1, 0.2, -1).normalized(), 90, 700, 0.05, random);
  add_clutter(points, 300, random);
  PrimitiveQuery query;
  query.use_normals = use_normals;
  if (known_radius) query.radius_mm = truth.radius_mm;
  const auto found = bench.finder.find(points, query, random);
  REQUIRE(found);
  CHECK(axis_error_deg(found->direction, truth.axis) < 0.2);
  CHECK(off_axis_mm(*found, truth) < 0.1);
  CHECK(found->radius_mm == Approx(truth.radius_mm).margin(0.1));
  CHECK(found->concave == (side < 0));
  CHECK(found->inlier_share == Approx(1200.0 / 2200).margin(0.06));
  CHECK(found->extent_mm == Approx(truth.length_mm).margin(3));
  CHECK((found->point_mm - truth.point_mm).norm() < 2.0);
  CHECK(found->rms_mm == Approx(0.05).margin(0.01));
}

TEST_CASE("planes and spheres are found, with and without normals", "[primitives]") {
  Bench bench;
  Random random(3);
  const bool use_normals = GENERATE(true, false);
  const Vec3 normal = Vec3(0.1, 0.2, -1).normalized(), at_mm(20, -10, 730);
  std::vector<OrientedPoint> points;
  add_plane(points, at_mm, normal, 90, 900, 0.1, random);
  const Vec3 centre_mm(10, 0, 690);
  for (int i = 0; i < 900; ++i) {
    Vec3 outward = gauss3(random).normalized();
    if (outward.z() > 0) outward = -outward;
    const Vec3 p = centre_mm + (25 + 0.1 * gauss(random)) * outward;
    points.push_back({p.cast<float>(), (outward + 0.03 * gauss3(random)).normalized().cast<float>()});
  }
  add_clutter(points, 500, random);
  PrimitiveQuery query;
  query.sigma_mm = 0.1;
  query.use_normals = use_normals;
  query.kind = PrimitiveKind::kPlane;
  const auto plane = bench.finder.find(points, query, random);
  REQUIRE(plane);
  CHECK(axis_error_deg(plane->direction, normal) < 0.1);
  CHECK(plane->direction.dot(normal) > 0);
  CHECK(std::abs((plane->point_mm - at_mm).dot(normal)) < 0.05);
  query.kind = PrimitiveKind::kSphere;
  const auto sphere = bench.finder.find(points, query, random);
  REQUIRE(sphere);
  CHECK((sphere->point_mm - centre_mm).norm() < 0.1);
  CHECK(sphere->radius_mm == Approx(25).margin(0.05));
  CHECK_FALSE(sphere->concave);
}

TEST_CASE("the side asked for is the side found", "[primitives]") {
  Bench bench;
  Random random(5);
  Cylinder boss, bore;
  bore.point_mm += Vec3(60, 0, 0), bore.radius_mm = 10;
  std::vector<OrientedPoint> points;
  add_cylinder(points, boss, 1500, rad_from_deg(150), 1, 0.05, random);
  add_cylinder(points, bore, 800, rad_from_deg(150), -1, 0.05, random);
  PrimitiveQuery query;
  query.side = Side::kBore;
  const auto found = bench.finder.find(points, query, random);
  REQUIRE(found);
  CHECK(found->concave);
  CHECK(found->radius_mm == Approx(10).margin(0.1));
}

TEST_CASE("a box's faces and its boss come one after the other", "[primitives]") {
  Bench bench;
  Random random(11);
  std::vector<OrientedPoint> points;
  add_plane(points, {0, 0, 700}, -Vec3::UnitZ(), 100, 2000, 0.05, random);
  add_plane(points, {50, 0, 750}, Vec3::UnitX(), 100, 1200, 0.05, random);
  Cylinder boss;
  boss.point_mm = {0, 0, 690}, boss.axis = Vec3::UnitY();
  add_cylinder(points, boss, 800, rad_from_deg(140), 1, 0.05, random);
  std::vector<PrimitiveQuery> queries(3);
  queries[0].kind = PrimitiveKind::kPlane;
  queries[1].kind = PrimitiveKind::kCylinder;
  queries[2].kind = PrimitiveKind::kSphere;
  std::array<Primitive, 8> found;
  const int count = bench.finder.find_sequence(points, queries, found, random);
  REQUIRE(count == 3);
  CHECK(found[0].kind == PrimitiveKind::kPlane);
  CHECK(found[0].inlier_share == Approx(0.5).margin(0.02));
  CHECK(found[1].kind == PrimitiveKind::kPlane);
  CHECK(found[2].kind == PrimitiveKind::kCylinder);
  CHECK(found[2].radius_mm == Approx(15).margin(0.1));
}

TEST_CASE("the fast cost is the sum of equation (5)", "[primitives]") {
  Bench bench;
  Random random(2);
  std::vector<OrientedPoint> points;
  add_cylinder(points, {}, 500, 2.0, 1, 0.3, random);
  add_clutter(points, 333, random);
  primitives::Cloud cloud(bench.arena = Arena(bench.block.data(), bench.block.bytes()), kMaxPoints);
  cloud.load(points);
  for (const auto kind : {PrimitiveKind::kPlane, PrimitiveKind::kCylinder, PrimitiveKind::kSphere}) {
    const primitives::Model model{kind, Vec3(1, 2, 3), Vec3(0.8, 0.5, 0.2).normalized(), 14.0, 1.0};
    PrimitiveQuery query;
    query.sigma_mm = 2.0;
    const double T = primitives::threshold_mm2(query);
    double expected = 0;
    for (int i = 0; i < cloud.count; ++i) {
      const auto r = primitives::residual(model, cloud.point(i));
      const bool agrees = r.outward.dot(cloud.normal(i)) >= std::cos(query.normal_angle_max_rad);
      expected += agrees ? std::min(r.distance_mm * r.distance_mm, T) : T;
    }
    CHECK(primitives::cost_mm2(cloud, model, query, 1e30) == Approx(expected).epsilon(1e-4));
    CHECK(primitives::cost_mm2(cloud, model, query, 0.3 * expected) > 0.3 * expected);
  }
}

TEST_CASE("the same seed gives the same bits; another order of calls does not matter", "[primitives]") {
  Bench bench;
  Random maker(9);
  std::vector<OrientedPoint> points;
  add_cylinder(points, {}, 900, 2.2, 1, 0.05, maker);
  add_clutter(points, 900, maker);
  Random first(42), second(42);
  const auto a = bench.finder.find(points, {}, first);
  (void)bench.finder.find(std::span(points).first(500), {}, maker);
  const auto b = bench.finder.find(points, {}, second);
  REQUIRE((a && b));
  CHECK(a->point_mm == b->point_mm);
  CHECK(a->direction == b->direction);
  CHECK(a->radius_mm == b->radius_mm);
}

TEST_CASE("nothing there, or too few points, is told by a code", "[primitives]") {
  Bench bench;
  Random random(1);
  std::vector<OrientedPoint> points;
  const auto none = bench.finder.find(points, {}, random);
  REQUIRE_FALSE(none);
  add_clutter(points, 2000, random);
  PrimitiveQuery query;
  query.min_share = 0.3;
  const auto found = bench.finder.find(points, query, random);
  CHECK_FALSE(found);
}
