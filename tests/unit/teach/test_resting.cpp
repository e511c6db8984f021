#include <catch2/catch.hpp>
#include <numeric>

#include "support/shapes.hpp"
#include "teach/resting.hpp"
#include "teach/surface.hpp"

using namespace beltpick;

namespace {

struct Part {
  Mesh mesh;
  teach::Surface surface;

  explicit Part(Mesh given) : mesh(std::move(given)) {
    teach::repair(mesh);
    surface = *teach::sample_mesh(mesh, 8000, 3);
  }
  [[nodiscard]] std::vector<RestingPosition> resting(const Symmetry& symmetry = {}) const {
    return teach::resting_positions(mesh.vertex_mm, teach::centre_of_gravity_mm(mesh, surface), symmetry);
  }
};

double sum(const std::vector<RestingPosition>& positions) {
  return std::accumulate(positions.begin(), positions.end(), 0.0,
                         [](double sum, const RestingPosition& r) { return sum + r.likelihood; });
}

}  // namespace

TEST_CASE("a box rests on its six faces, mostly on the large ones", "[teach][resting]") {
  const Part box(test::box(60, 40, 20));
  CHECK((teach::centre_of_gravity_mm(box.mesh, box.surface) - Vec3(30, 20, 10)).norm() < 1e-3);
  const auto positions = box.resting();
  REQUIRE(positions.size() == 6);
  CHECK(sum(positions) == Approx(1.0));
  CHECK(std::abs(positions[0].down.z()) > 0.999);
  CHECK(std::abs(positions[1].down.z()) > 0.999);
  CHECK(positions[0].height_mm == Approx(10).margin(0.2));
  CHECK(std::abs(positions[5].down.x()) > 0.999);
  CHECK(positions[5].height_mm == Approx(30).margin(0.2));
  CHECK(positions[0].likelihood + positions[1].likelihood > 0.5);
  // The slow and obvious: the solid angle in which a face is under the centre of gravity, for the two largest.
  CHECK(positions[0].likelihood == Approx(positions[1].likelihood).margin(0.02));
}

TEST_CASE("positions that the part's symmetry makes alike are one", "[teach][resting]") {
  const Part box(test::box(60, 40, 20));
  Symmetry symmetry;
  Pose<frame::Part, frame::Part> turn;
  turn.rotation = Eigen::AngleAxisd(kPi, Vec3::UnitX()).toRotationMatrix();
  turn.translation_mm = Vec3(0, 40, 20);
  symmetry.elements.push_back(turn);
  CHECK(box.resting(symmetry).size() == 4);
}

TEST_CASE("a tall part off its centre of gravity falls over", "[teach][resting]") {
  // A foot of 10 x 10 under an arm that hangs out to one side: it cannot stand on the foot.
  Mesh mesh;
  test::add_box(mesh, {0, 0, 0}, {10, 10, 40});
  test::add_box(mesh, {10, 0, 30}, {60, 10, 40});
  const Part part(mesh);
  for (const RestingPosition& position : part.resting()) {
    INFO(position.down.transpose());
    CHECK(position.down.z() > -0.99);
  }
}

TEST_CASE("a cylinder lies on its side or stands on an end", "[teach][resting]") {
  Mesh mesh;
  test::add_cylinder(mesh, {0, 0, 0}, 10, 60);
  const Part part(mesh);
  Symmetry symmetry;
  symmetry.name = "revolution";
  symmetry.revolution = true;
  symmetry.axis_point_mm = {0, 0, 30};
  const auto positions = part.resting(symmetry);
  REQUIRE(positions.size() >= 3);
  CHECK(std::abs(positions[0].down.z()) < 0.05);
  CHECK(positions[0].height_mm == Approx(10).margin(0.2));
  CHECK(positions[0].likelihood > 0.6);
}
