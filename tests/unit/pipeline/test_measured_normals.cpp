// The normals of measured points, beside the eigenvectors of all the points in the window.
#include "pipeline/measured_normals.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "base/random.hpp"

using namespace beltpick;

namespace {

constexpr int kSide = 41, kMiddle = kSide / 2;
constexpr float kPitch_mm = 0.4F, kAway_mm = 600.0F;

// A square of the image that sees `depth_mm` of its column and row, from far away.
struct Patch {
  std::vector<Vec3f> point_mm;

  template <class Depth>
  explicit Patch(const Depth& depth_mm, float noise_mm, std::uint64_t seed) {
    Random random(seed);
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        const float x = kPitch_mm * static_cast<float>(col - kMiddle),
                    y = kPitch_mm * static_cast<float>(row - kMiddle);
        const auto noise = noise_mm * static_cast<float>(random.uniform(-1.7, 1.7));
        point_mm.emplace_back(x, y, kAway_mm + depth_mm(x, y) + noise);
      }
    }
  }
  [[nodiscard]] RangeImage range() { return {{point_mm.data(), kSide, kSide}, {}, {}}; }
  [[nodiscard]] std::optional<Vec3f> normal(int row = kMiddle, int col = kMiddle) {
    return pipeline::measured_normal(range(), row, col, 1.6F);
  }
};

// The normal of the 25 pixels, two apart, that a radius of 1.6 mm takes in here.
Vec3f oracle(const Patch& patch) {
  Eigen::Matrix<double, 3, 25> points;
  int count = 0;
  for (int r = -2; r <= 2; ++r) {
    for (int c = -2; c <= 2; ++c)
      points.col(count++) =
          patch.point_mm[static_cast<std::size_t>((kMiddle + 2 * r) * kSide + kMiddle + 2 * c)].cast<double>();
  }
  const Eigen::Matrix<double, 3, 25> arms = points.colwise() - points.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(arms * arms.transpose());
  const Vec3 normal = axes.eigenvectors().col(0);
  return (normal.z() > 0.0 ? Vec3(-normal) : normal).cast<float>();
}

double apart_deg(const Vec3f& a, const Vec3f& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / 3.14159265358979;
}

}  // namespace

TEST_CASE("the normal is the direction in which the points of the window spread least", "[measured_normals]") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(1000 + seed);
    const auto slope_x = static_cast<float>(random.uniform(-2.5, 2.5)),
               slope_y = static_cast<float>(random.uniform(-2.5, 2.5));
    const auto bend = static_cast<float>(random.uniform(-0.05, 0.05));
    const auto noise_mm = static_cast<float>(random.uniform(0.0, 0.08));
    Patch patch([&](float x, float y) { return slope_x * x + slope_y * y + bend * x * x; }, noise_mm, seed);
    const auto normal = patch.normal();
    CAPTURE(seed, slope_x, slope_y, bend, noise_mm);
    REQUIRE(normal);
    CHECK(normal->norm() == Approx(1.0F).margin(1e-5));
    CHECK(normal->z() < 0.0F);
    CHECK(apart_deg(*normal, oracle(patch)) < 0.05);
  }
}

TEST_CASE("points on a line, too few points and a corner of the image", "[measured_normals]") {
  const auto level = [](float, float) { return 0.0F; };
  Patch line(level, 0.02F, 1);
  for (int i = 0; i < kSide * kSide; ++i) {
    if (i / kSide != kMiddle) line.point_mm[static_cast<std::size_t>(i)].setZero();
  }
  CHECK_FALSE(line.normal());

  Patch nothing(level, 0.0F, 1);
  for (int i = 0; i < kSide * kSide; ++i) {
    if (i != kMiddle * kSide + kMiddle) nothing.point_mm[static_cast<std::size_t>(i)].setZero();
  }
  CHECK_FALSE(nothing.normal());

  Patch whole(level, 0.0F, 1);
  for (const int row : {0, kSide - 1}) {
    for (const int col : {0, kSide - 1}) {
      const auto normal = whole.normal(row, col);
      REQUIRE(normal);
      CHECK(apart_deg(*normal, -Vec3f::UnitZ()) < 0.01);
    }
  }
}

TEST_CASE("what lies beyond a step does not tilt the normal", "[measured_normals]") {
  Patch step([](float x, float) { return x > 0.5F ? 30.0F : 0.0F; }, 0.0F, 1);
  const auto normal = step.normal();
  REQUIRE(normal);
  CHECK(apart_deg(*normal, -Vec3f::UnitZ()) < 0.01);
}

TEST_CASE("pixels asked for together have the normals that each has by itself", "[measured_normals]") {
  Patch patch([](float x, float y) { return x > 3.0F ? 20.0F : 0.1F * x * x - 0.3F * y; }, 0.04F, 5);
  Random random(6);
  for (int hole = 0; hole < 300; ++hole) patch.point_mm[random.below(kSide * kSide)].setZero();
  const RangeImage range = patch.range();
  for (int trial = 0; trial < 60; ++trial) {
    pipeline::PixelBlock pixels;
    const int wanted = 1 + trial % pipeline::PixelBlock::kSize;
    while (pixels.count < wanted) {
      const auto row = static_cast<int>(random.below(kSide)), col = static_cast<int>(random.below(kSide));
      if (range.valid(row, col)) pixels.add(row, col);
    }
    pipeline::NormalBlock together;
    pipeline::measured_normals(range, pixels, 1.6F, together);
    for (std::size_t k = 0; k < static_cast<std::size_t>(wanted); ++k) {
      const auto alone = patch.normal(pixels.row[k], pixels.col[k]);
      REQUIRE(alone.has_value() == (together.found[k] != 0));
      if (alone) CHECK(*alone == together.at(k));
    }
  }
}
