#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "support/shapes.hpp"
#include "teach/demands.hpp"
#include "teach/rehearsal.hpp"
#include "virtual_cell/render/scene_part.hpp"

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

TEST_CASE("a cut view shows so much of the part, where it lay", "[teach][rehearsal]") {
  const teach::Triangles triangles = teach::triangles_of(test::box(60, 40, 20), {});
  teach::SimulatedView view = teach::simulate_view(triangles, 75, {{0, 0, -1}, 0.3, 5, -8}, 0.0, 1);
  for (const auto side :
       {teach::CutSide::kLeft, teach::CutSide::kRight, teach::CutSide::kTop, teach::CutSide::kBottom}) {
    const pipeline::View cut = teach::cut(view, 0.3, side);
    const auto inside = std::count_if(view.of_part.begin(), view.of_part.end(), [&](const OrientedPoint& point) {
      const Vec3f& p = point.point_mm;
      const double col = p.x() / p.z() * cut.lens.fx_px + cut.lens.cx_px;
      const double row = p.y() / p.z() * cut.lens.fy_px + cut.lens.cy_px;
      if (!cut.range.point_mm.contains(static_cast<int>(std::lround(row)), static_cast<int>(std::lround(col))))
        return false;
      return (cut.range.point_mm(static_cast<int>(std::lround(row)), static_cast<int>(std::lround(col))) - p).norm() <
             1e-3F;
    });
    CHECK(static_cast<double>(inside) / static_cast<double>(view.of_part.size()) == Approx(0.3).margin(0.03));
  }
}

TEST_CASE("where a believed pose was wrong, the part must show more; never less than any part", "[teach][rehearsal]") {
  teach::Demands demands;
  CHECK(demands.derived() == Requirements{});
  for (int i = 0; i < 4; ++i) demands.believed(0.9, 0.05, false);
  CHECK(demands.derived().support == Requirements{}.support);
  CHECK(demands.derived().residual == 0.2);
  demands.believed(0.27, 0.3, true);
  CHECK(demands.derived().support == Approx(0.32));
  demands.believed(0.9, 0.3, true);
  CHECK(demands.derived().support < 0.5);
  CHECK(demands.wrong() == 2);
  demands.believed(0.9, 0.5, false);
  CHECK(demands.derived().residual == Requirements{}.residual);
}

TEST_CASE("an elbow of which one leg alone is inside the image is right or withheld", "[teach][rehearsal]") {
  // The other leg may stand up or lie: with the wrong one that leg shows less of itself, all of it as measured.
  const Mesh elbow = virtual_cell::builtin_part("elbow").value().mesh;
  auto taught = teach::teach(elbow, {}, {});
  REQUIRE(taught.has_value());
  const auto rehearsal = teach::rehearse(*taught, elbow, 8);
  REQUIRE(rehearsal.has_value());
  CHECK(rehearsal->cut_wrong == 0);
  CHECK(rehearsal->count(teach::Outcome::kFound) == 8);
}

TEST_CASE("the rehearsal finds a bracket, tells how exactly, and chooses the search's steps", "[teach][rehearsal]") {
  auto taught = teach::teach(test::bracket(), {}, {.points = 12000});
  REQUIRE(taught.has_value());
  CHECK(taught->part.steps.turn_rad == 0.0);
  const auto rehearsal = teach::rehearse(*taught, test::bracket(), 5);
  REQUIRE(rehearsal.has_value());
  CHECK(rehearsal->views.size() == 5);
  CHECK(rehearsal->count(teach::Outcome::kWrong) == 0);
  for (const teach::RehearsedView& view : rehearsal->views)
    UNSCOPED_INFO("resting " << view.resting << ": " << view.why);
  // On two of its sides its mirror image, or the same bracket shifted, shows the same.
  CHECK(rehearsal->count(teach::Outcome::kFound) >= 3);
  CHECK(rehearsal->count(teach::Outcome::kFound) + rehearsal->count(teach::Outcome::kAmbiguous) == 5);
  for (std::size_t k = 0; k < 3; ++k) CHECK(rehearsal->rms_error[k] < rad_from_deg(0.5));
  for (std::size_t k = 3; k < 6; ++k) CHECK(rehearsal->rms_error[k] < 0.5);
  CHECK(taught->part.steps.turn_rad >= rad_from_deg(5));
  CHECK(taught->part.steps.turn_rad <= rad_from_deg(30));
  CHECK(taught->part.steps.shift_mm > 0.5);
  REQUIRE(taught->part.requirements.has_value());
  CHECK(taught->part.requirements->residual >= 0.2);
  CHECK(taught->part.requirements->residual <= Requirements{}.residual);
  CHECK(rehearsal->basin.home_at_steps >= 0.85);
  // Starts farther away come home less often.
  for (const auto& home : rehearsal->basin.home) CHECK(home.front() >= home.back());
}
