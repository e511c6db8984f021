#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "support/shapes.hpp"
#include "teach/rehearsal.hpp"

using namespace beltpick;

TEST_CASE("a simulated view measures the part where the truth says", "[teach][rehearsal]") {
  Mesh mesh = test::box(60, 40, 20);
  const teach::Triangles triangles = teach::triangles_of(mesh, {});
  const teach::SimulatedView view = teach::simulate_view(triangles, 75, {{0, 0, -1}, 0.3, 5, -8}, 0.0, 1);
  REQUIRE(view.of_part.size() > 5000);
  const auto T_part_camera = view.T_camera_part.inverse();
  for (std::size_t i = 0; i < view.of_part.size(); i += 7) {
    const Vec3 at = T_part_camera * view.of_part[i].point_mm.cast<double>();
    const Vec3 normal = T_part_camera.rotation * view.of_part[i].normal.cast<double>();
    // On the upper face, but for slivers of the sides at the edge of the view.
    if (normal.z() > 0.9) CHECK(at.z() == Approx(20).margin(1e-3));
    CHECK(at.x() > -1e-3);
    CHECK(at.x() < 60 + 1e-3);
  }
  // The box casts a shadow on the belt: something is not measured.
  CHECK(std::count_if(view.point_mm.begin(), view.point_mm.end(), [](const Vec3f& p) { return p.z() == 0; }) > 500);
}

TEST_CASE("the rehearsal finds a bracket, tells how exactly, and chooses the search's steps", "[teach][rehearsal]") {
  auto taught = teach::teach(test::bracket(), {}, {.points = 12000});
  REQUIRE(taught.has_value());
  CHECK(taught->part.steps.turn_rad == 0.0);
  const auto rehearsal = teach::rehearse(*taught, test::bracket(), 5);
  REQUIRE(rehearsal.has_value());
  CHECK(rehearsal->views.size() == 5);
  CHECK(rehearsal->count(teach::Outcome::kWrong) == 0);
  CHECK(rehearsal->count(teach::Outcome::kFound) >= 4);
  for (std::size_t k = 0; k < 3; ++k) CHECK(rehearsal->rms_error[k] < rad_from_deg(0.5));
  for (std::size_t k = 3; k < 6; ++k) CHECK(rehearsal->rms_error[k] < 0.5);
  CHECK(taught->part.steps.turn_rad >= rad_from_deg(5));
  CHECK(taught->part.steps.turn_rad <= rad_from_deg(30));
  CHECK(taught->part.steps.shift_mm > 0.5);
  CHECK(rehearsal->basin.home_at_steps >= 0.85);
  // Starts farther away come home less often.
  for (const auto& home : rehearsal->basin.home) CHECK(home.front() >= home.back());
}
