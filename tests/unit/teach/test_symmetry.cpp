#include <catch2/catch.hpp>

#include "support/shapes.hpp"
#include "teach/teach.hpp"
#include "virtual_cell/render/implicit_mesh.hpp"
#include "virtual_cell/render/scene_part.hpp"

using namespace beltpick;

namespace {

Symmetry symmetry_of(Mesh mesh) {
  const auto taught = teach::teach(std::move(mesh), {}, {.points = 12000});
  REQUIRE(taught.has_value());
  return taught->part.symmetry;
}

// The same part lying askew in its file.
Mesh turned(Mesh mesh) {
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (Vec3f& v : mesh.vertex_mm) v = (turn * v.cast<double>() + Vec3(40, -30, 100)).cast<float>();
  return mesh;
}

}  // namespace

TEST_CASE("boxes have the symmetry of their sides", "[teach][symmetry]") {
  CHECK(symmetry_of(turned(test::box(60, 40, 20))).name == "D2");
  CHECK(symmetry_of(test::box(40, 40, 15)).name == "D4");
  const Symmetry cube = symmetry_of(turned(test::box(30, 30, 30)));
  CHECK(cube.name == "O");
  CHECK(cube.elements.size() == 23);
}

TEST_CASE("a plain cylinder is of revolution and can be flipped; a stepped one cannot", "[teach][symmetry]") {
  Mesh plain;
  test::add_cylinder(plain, {0, 0, 0}, 15, 60, 180);
  const Symmetry symmetry = symmetry_of(turned(plain));
  CHECK(symmetry.name == "revolution");
  CHECK(symmetry.revolution);
  CHECK(symmetry.elements.size() == 1);
  Mesh stepped = plain;
  test::add_cylinder(stepped, {0, 0, 60}, 9, 10, 180);
  const Symmetry of_stepped = symmetry_of(stepped);
  CHECK(of_stepped.name == "revolution");
  CHECK(of_stepped.elements.empty());
  CHECK(std::abs(of_stepped.axis_direction.z()) > 0.9999);
}

TEST_CASE("a part without symmetry has none, and a small mark is told", "[teach][symmetry]") {
  CHECK(symmetry_of(turned(test::bracket())).name == "none");
  Mesh marked = test::box(60, 40, 20);
  test::add_box(marked, {5, 5, 20}, {10, 10, 24});
  const auto taught = teach::teach(marked, {}, {.points = 12000});
  CHECK(taught->part.symmetry.name == "none");
  REQUIRE(taught->nearest_turn.has_value());
  CHECK(taught->nearest_turn->differing_share < 0.05);
  CHECK(!taught->warnings.empty());
}

TEST_CASE("a meshed part has the symmetry that it is known to have", "[teach][symmetry]") {
  for (const std::string& name : virtual_cell::builtin_part_names()) {
    const auto part = virtual_cell::builtin_part(name);
    REQUIRE(part);
    const auto taught = teach::teach(part->mesh, {}, {});
    REQUIRE(taught);
    INFO(name << ": " << taught->part.symmetry.name);
    CHECK(taught->part.symmetry.elements.size() == part->symmetries.size());
  }
}

TEST_CASE("a flange meshed from its volume, askew to the cells, has the symmetry of its four holes",
          "[teach][symmetry]") {
  const auto flange = [](const Vec3& at) {
    const Vec3 p = Eigen::AngleAxisd(0.3, Vec3::UnitZ()) * at + Vec3(0.37, 0.21, 0.13);
    const double r = std::hypot(p.x(), p.y());
    const double disc = std::max({r - 40.0, -p.z(), p.z() - 8.0});
    const double hub = std::max({r - 20.0, -p.z(), p.z() - 30.0});
    double distance = std::max(std::min(disc, hub), 12.0 - r);
    for (const auto& [x, y] : {std::pair{30.0, 0.0}, {0.0, 30.0}, {-30.0, 0.0}, {0.0, -30.0}})
      distance = std::max(distance, 4.5 - std::hypot(p.x() - x, p.y() - y));
    return distance;
  };
  for (const double cell_mm : {0.8, 1.0}) {
    const Mesh mesh = virtual_cell::mesh_of_solid(flange, {Vec3(-43, -43, -3), Vec3(43, 43, 33)}, cell_mm);
    const auto taught = teach::teach(mesh, {}, {});
    REQUIRE(taught.has_value());
    INFO(cell_mm << " mm cells; a turn changes " << (taught->nearest_turn ? taught->nearest_turn->differing_share : 0.0)
                 << " of the surface");
    CHECK(taught->part.symmetry.name == "C4");
  }
}

TEST_CASE("a mark that is one part in a thousand of the surface breaks a symmetry", "[teach][symmetry]") {
  Mesh marked = test::box(60, 40, 20);
  test::add_box(marked, {5, 5, 20}, {8, 8, 21});
  CHECK(symmetry_of(marked).name == "none");
}
