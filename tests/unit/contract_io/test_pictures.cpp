#include <catch2/catch.hpp>

#include <vector>

#include "contract_io/pictures.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;

TEST_CASE("the range picture is black where nothing was measured, red near and blue far", "[pictures]") {
  std::vector<float> z(100 * 100);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = i < 100 ? 0.0F : 600.0F + static_cast<float>(i) * 0.01F;
  const Picture picture = range_picture({z.data(), 100, 100});
  CHECK(picture.view()(0, 5) == Rgb{0, 0, 0});
  CHECK(picture.view()(1, 0)[0] > 200);
  CHECK(picture.view()(99, 99)[2] > 200);
  CHECK(range_picture({z.data(), 1, 100}).view()(0, 0) == Rgb{0, 0, 0});
}

TEST_CASE("objects have their own colours over the grey", "[pictures]") {
  const std::vector<std::uint16_t> labels{0, 1, 2, 3};
  const std::vector<std::uint8_t> texture{90, 90, 90, 90};
  const Picture picture = labels_picture({labels.data(), 1, 4}, {texture.data(), 1, 4});
  CHECK(picture.view()(0, 0) == Rgb{90, 90, 90});
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) CHECK(picture.view()(0, a) != picture.view()(0, b));
  }
}

TEST_CASE("the overlay tints where the part appears and nowhere else", "[pictures]") {
  const std::vector<std::uint8_t> texture(100 * 100, 50);
  Lens camera;
  camera.width = camera.height = 100;
  camera.fx_px = camera.fy_px = 100;
  camera.cx_px = camera.cy_px = 50;
  PartTemplate part;
  part.spacing_mm = 2.0;
  for (int x = -10; x <= 10; x += 2) {
    for (int y = -10; y <= 10; y += 2) {
      part.point_mm.emplace_back(x, y, 0);
      part.normal.emplace_back(0, 0, -1);
    }
  }
  LocatedPart found;
  found.T_camera_part.translation_mm = {20, 0, 100};
  const Picture picture = overlay_picture({texture.data(), 100, 100}, {&found, 1}, {&part, 1}, camera);
  CHECK(picture.view()(50, 70) != Rgb{50, 50, 50});
  CHECK(picture.view()(50, 50) == Rgb{50, 50, 50});
  CHECK(picture.view()(50, 58) == object_colour(1));
}
