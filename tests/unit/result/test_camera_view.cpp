// What the camera sees of a block of points, beside the plain camera model.
#include "result/camera_view.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "base/random.hpp"
#include "contract/lens_project.hpp"

using namespace beltpick;

TEST_CASE("points of a block appear where the lens has them, and face the camera where they do", "[camera_view]") {
  Lens lens;
  lens.width = 1280, lens.height = 960;
  lens.fx_px = 2240.0, lens.fy_px = 2241.0, lens.cx_px = 645.0, lens.cy_px = 475.0;
  lens.distortion = {-0.146, 0.114, 5e-4, -4e-4, 0.07};
  Random random(5);
  PointBlock block;
  const int count = 50;  // not a whole number of steps
  for (int i = 0; i < count; ++i) {
    const Vec3f at(static_cast<float>(random.uniform(-300, 300)), static_cast<float>(random.uniform(-250, 250)),
                   static_cast<float>(random.uniform(450, 800)));
    const Vec3f normal(static_cast<float>(random.uniform(-1, 1)), static_cast<float>(random.uniform(-1, 1)),
                       static_cast<float>(random.uniform(-1, 1)));
    block.put({at, normal.normalized()}, i);
  }
  block.fill_up(count);
  result::Seen seen;
  result::look_at(block, result::Optics(lens), 1.0F, count, seen);
  int facing = 0, outside = 0;
  for (std::size_t k = 0; k < count; ++k) {
    CAPTURE(k);
    const Vec3 at(static_cast<double>(block.x[k]), static_cast<double>(block.y[k]), static_cast<double>(block.z[k]));
    const Vec3 normal(static_cast<double>(block.nx[k]), static_cast<double>(block.ny[k]),
                      static_cast<double>(block.nz[k]));
    const PixelPosition expected = project(lens, at);
    const double cosine = -normal.dot(at) / at.norm();
    CHECK(std::abs(static_cast<double>(seen.column_px[k]) - expected.column_px) < 1e-2);
    CHECK(std::abs(static_cast<double>(seen.row_px[k]) - expected.row_px) < 1e-2);
    CHECK(std::abs(static_cast<double>(seen.cosine[k]) - cosine) < 1e-4);
    CHECK((seen.facing[k] == 1) == (cosine > 0.02 && in_field(lens, at)));
    facing += seen.facing[k];
    outside += in_field(lens, at) ? 0 : 1;
    if (cosine <= 0.02) continue;
    const double steepness = std::sqrt(1.0 - cosine * cosine) / cosine;
    CHECK(static_cast<double>(seen.own_mm[k]) == Approx(1.0 + 2.0 * steepness).epsilon(1e-3));
  }
  CHECK(facing > 5);
  CHECK(outside > 2);
}
