#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "contract/result_codes.hpp"
#include "contract_io/cloud_io.hpp"
#include "contract_io/npy_io.hpp"
#include "samples.hpp"
#include "support/temp_folder.hpp"

using namespace beltpick;
using namespace beltpick::contract_io;
using namespace beltpick::test;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Scene {
  std::vector<Vec3f> points{{1, 2, 700}, {0, 0, 0}, {3, 4, 701.01F}, {5, 6, 2000}};
  std::vector<std::uint8_t> texture{9, 10, 11, 12};
  RangeImage range() { return {{points.data(), 2, 2}, {}, {texture.data(), 2, 2}}; }
};

}  // namespace

TEST_CASE("NaN, infinity, zero and what lies behind the camera is not measured", "[cloud]") {
  const TempFolder folder;
  const std::vector<float> values{1, 2, 700, 0, 0, 0, kNan, kNan, kNan, 1, kNan, 5, 1, 2, -3, 1, INFINITY, 9};
  REQUIRE(write_npy<float>(folder / "c.npy", values, {2, 3, 3}));
  Warnings warnings;
  auto cloud = read_cloud(folder / "c.npy", warnings);
  REQUIRE(cloud);
  const RangeImage range = cloud->view();
  CHECK(range.valid(0, 0));
  CHECK(range.point_mm(0, 0) == Vec3f(1, 2, 700));
  int valid = 0;
  for (int r = 0; r < 2; ++r) {
    for (int c = 0; c < 3; ++c) valid += range.valid(r, c) ? 1 : 0;
  }
  CHECK(valid == 1);
  CHECK(cloud->point_mm[1] == Vec3f(0, 0, 0));
  CHECK(cloud->point_mm[2] == Vec3f(0, 0, 0));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("behind the camera") != std::string::npos);
}

TEST_CASE("A cloud in metres is suspected, an empty one refused", "[cloud]") {
  const TempFolder folder;
  Warnings warnings;
  REQUIRE(write_npy<float>(folder / "m.npy", std::vector<float>{0.1F, 0.1F, 0.7F}, {1, 1, 3}));
  CHECK(read_cloud(folder / "m.npy", warnings));
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].find("metres") != std::string::npos);
  REQUIRE(write_npy<float>(folder / "e.npy", std::vector<float>{kNan, kNan, kNan}, {1, 1, 3}));
  const auto empty = read_cloud(folder / "e.npy", warnings);
  REQUIRE_FALSE(empty);
  CHECK(empty.error().code == ResultCode::kTooFewPoints);
}

TEST_CASE("cloud.npy reads back, with NaN for gaps", "[cloud]") {
  const TempFolder folder;
  Scene scene;
  REQUIRE(write_cloud_npy(folder / "c.npy", scene.range()));
  const auto raw = read_npy<float>(folder / "c.npy", {2, 2, 3});
  REQUIRE(raw);
  CHECK(std::isnan(raw->values[3]));
  Warnings warnings;
  const auto cloud = read_cloud(folder / "c.npy", warnings);
  REQUIRE(cloud);
  CHECK(cloud->point_mm == scene.points);
  CHECK(warnings.empty());
}

TEST_CASE("cloud.ply holds the valid points and their intensity", "[cloud]") {
  const TempFolder folder;
  Scene scene;
  REQUIRE(write_cloud_ply(folder / "c.ply", scene.range()));
  const std::string bytes = file_bytes(folder / "c.ply");
  CHECK(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
  CHECK(bytes.find("element vertex 3\n") != std::string::npos);
  const std::size_t body = bytes.find("end_header\n") + 11;
  REQUIRE(bytes.size() - body == 3 * 13);
  float xyz[3];
  std::memcpy(xyz, bytes.data() + body + 13, sizeof xyz);
  CHECK(xyz[2] == 701.01F);
  CHECK(bytes[body + 12] == 9);
  CHECK(bytes[body + 25] == 11);
}

TEST_CASE("range.png counts 0.02 mm", "[cloud]") {
  const TempFolder folder;
  Scene scene;
  REQUIRE(write_range_png(folder / "r.png", scene.range()));
  const auto image = read_grey_image(folder / "r.png");
  REQUIRE(image);
  CHECK(image->pixels16 == std::vector<std::uint16_t>{35000, 0, 35051, 65535});
}
