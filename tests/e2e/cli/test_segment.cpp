// beltpick segment and primitives on a cloud made from a known cylinder on a leaning plane.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/pose.hpp"
#include "base/random.hpp"
#include "contract_io/npy_io.hpp"
#include "workshop.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

constexpr int kRows = 240, kCols = 320;
constexpr double kFocal_px = 500.0, kRadius_mm = 25.0, kLength_mm = 120.0;
const Vec3 kAxis = Vec3(1.0, 0.3, -0.1).normalized();
const Vec3 kMiddle_mm(0.0, 0.0, 685.0);

// Range along a line of sight of z = 1 to the cylinder, or infinity.
double range_to_cylinder(const Vec3& sight) {
  const Vec3 s = sight - sight.dot(kAxis) * kAxis, m = kMiddle_mm - kMiddle_mm.dot(kAxis) * kAxis;
  const double under_root = s.dot(m) * s.dot(m) - s.dot(s) * (m.dot(m) - kRadius_mm * kRadius_mm);
  if (under_root < 0) return INFINITY;
  const double range = (s.dot(m) - std::sqrt(under_root)) / s.dot(s);
  return std::abs((range * sight - kMiddle_mm).dot(kAxis)) < kLength_mm / 2 ? range : INFINITY;
}

void write_cloud(const std::filesystem::path& path) {
  const Vec3 plane_normal(0.1, 0.3, 1.0);
  Random random(4);
  std::vector<float> xyz;
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const Vec3 sight((col - kCols / 2) / kFocal_px, (row - kRows / 2) / kFocal_px, 1.0);
      const double range =
          std::min(range_to_cylinder(sight), 700.0 / plane_normal.dot(sight)) + random.uniform(-0.1, 0.1);
      for (const double value : {range * sight.x(), range * sight.y(), range}) xyz.push_back(static_cast<float>(value));
    }
  }
  REQUIRE(contract_io::write_npy<float>(path, xyz, {kRows, kCols, 3}));
}

}  // namespace

TEST_CASE("segment labels the object and nothing else, and draws it", "[cli]") {
  const TempFolder folder;
  write_cloud(folder / "cloud.npy");
  const std::string base = folder.path().string();
  const Outcome outcome = beltpick_run("segment " + base + "/cloud.npy --out " + base + "/labels.npy --overlay " +
                                       base + "/labels.png --json");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto answer = nlohmann::json::parse(outcome.out);
  REQUIRE(answer["segments"].size() == 1);
  const auto labels = contract_io::read_npy<std::uint16_t>(folder / "labels.npy", {kRows, kCols});
  REQUIRE(labels);
  CHECK(labels->values[kRows / 2 * kCols + kCols / 2] == 1);
  CHECK(labels->values[0] == 0);
  CHECK(std::count(labels->values.begin(), labels->values.end(), 1) == answer["segments"][0]["pixels"].get<int>());
  CHECK(std::filesystem::file_size(folder / "labels.png") > 1000);
}

TEST_CASE("primitives tells axis and radius of the object, known or not", "[cli]") {
  const TempFolder folder;
  write_cloud(folder / "cloud.npy");
  const std::string options = GENERATE("--kind cylinder", "--kind cylinder --radius-mm 25", "");
  const Outcome outcome = beltpick_run("primitives " + (folder / "cloud.npy").string() + " --json " + options);
  INFO(options << outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const auto answer = nlohmann::json::parse(outcome.out);
  REQUIRE(answer["segments"].size() == 1);
  REQUIRE_FALSE(answer["segments"][0]["primitives"].empty());
  const auto& cylinder = answer["segments"][0]["primitives"][0];
  CHECK(cylinder["kind"] == "cylinder");
  CHECK(cylinder["radius_mm"].get<double>() == Approx(kRadius_mm).margin(0.2));
  const Vec3 axis(cylinder["axis"][0], cylinder["axis"][1], cylinder["axis"][2]);
  CHECK(axis.cross(kAxis).norm() < 0.01);
  CHECK(cylinder["inlier_share"].get<double>() > 0.9);
}

TEST_CASE("a plane has no radius", "[cli]") {
  const Outcome outcome = beltpick_run("primitives cloud.npy --kind plane --radius-mm 5");
  CHECK(outcome.exit_code != 0);
  CHECK(outcome.error_lines() == 1);
}
