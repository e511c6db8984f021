// The lens of a foreign cloud, found in the cloud.
#include <catch2/catch.hpp>

#include "contract/lens_project.hpp"
#include "contract/result_codes.hpp"
#include "pipeline/lens_fit.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

TEST_CASE("the fitted lens sees the cloud where its camera saw it") {
  const Shape shape = bracket();
  const PartTemplate part = template_of(shape, 3000);
  SceneImage image = render({{&shape, on_belt(shape, part, Mat3::Identity(), 0, 0)}});
  const auto lens = pipeline::fit_lens({image.range().point_mm, {}, {}});
  REQUIRE(lens);
  double worst_px = 0.0;
  for (int row = 0; row < image.lens.height; row += 20) {
    for (int col = 0; col < image.lens.width; col += 20) {
      if (!image.range().valid(row, col)) continue;
      const PixelPosition at = project(*lens, image.range().point_mm(row, col).cast<double>());
      worst_px = std::max({worst_px, std::abs(at.column_px - col), std::abs(at.row_px - row)});
    }
  }
  CHECK(worst_px < 0.2);
}

TEST_CASE("a cloud that no lens explains is refused") {
  std::vector<Vec3f> points(100 * 100);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = Vec3f(static_cast<float>(i * 7919 % 301), static_cast<float>(i * 104729 % 211), 500.0F);
  }
  const auto lens = pipeline::fit_lens({{points.data(), 100, 100}, {}, {}});
  REQUIRE_FALSE(lens);
  CHECK(lens.error().code == ResultCode::kFormatInvalid);
}

TEST_CASE("an empty cloud has too few points") {
  std::vector<Vec3f> points(100 * 100, Vec3f::Zero());
  const auto lens = pipeline::fit_lens({{points.data(), 100, 100}, {}, {}});
  REQUIRE_FALSE(lens);
  CHECK(lens.error().code == ResultCode::kTooFewPoints);
}
