#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "calibrate/belt_frame.hpp"
#include "contract/result_codes.hpp"
#include "sample_rig.hpp"

using namespace beltpick;
using namespace beltpick::calibrate;

namespace {

constexpr int kRows = 120, kCols = 160;

// A belt tilted by 3 degrees 700 mm from a camera that sees 0.002 rad a pixel, with 0.05 mm of noise along the ray; a
// box of 40 mm lies on a fifth of it, and a tenth was not measured.
std::vector<Vec3f> tilted_belt(const Plane& belt, double noise_mm) {
  Random random(3);
  std::vector<Vec3f> points;
  for (int row = 0; row < kRows; ++row) {
    for (int col = 0; col < kCols; ++col) {
      const Vec3 ray(0.002 * (col - kCols / 2), 0.002 * (row - kRows / 2), 1.0);
      const double height_mm = col < kCols / 5 ? 40.0 : 0.0;
      const double noise = noise_mm * (random.uniform() + random.uniform() + random.uniform() - 1.5) * 2.0;
      const double z_mm = (belt.offset_mm + height_mm) / belt.normal.dot(ray) + noise;
      points.push_back(row % 10 == 0 ? Vec3f::Zero() : Vec3f((z_mm * ray).cast<float>()));
    }
  }
  return points;
}

Plane sample_belt() {
  const Vec3 normal = Eigen::AngleAxisd(0.052, Vec3(1, 0.3, 0).normalized()) * Vec3(0, 0, -1);
  return {normal, normal.dot(Vec3(0, 0, 700))};
}

}  // namespace

TEST_CASE("The belt's plane is found beside what lies on it", "[calibrate]") {
  const Plane truth = sample_belt();
  std::vector<Vec3f> points = tilted_belt(truth, 0.05);
  const RangeImage range{{points.data(), kRows, kCols}, {}, {}};
  const Plane rough{(truth.normal + Vec3(0.001, -0.001, 0)).normalized(), truth.offset_mm + 0.5};
  const auto belt = fit_belt_plane(range, rough);
  REQUIRE(belt);
  CHECK(std::acos(belt->plane.normal.dot(truth.normal)) < 2e-5);
  CHECK(belt->plane.offset_mm == Approx(truth.offset_mm).margin(0.005));
  CHECK(belt->plane.normal.z() < 0.0);
  CHECK(belt->rms_mm == Approx(0.05).margin(0.01));
  CHECK(belt->bow_mm < 0.02);
  CHECK(belt->inlier_share == Approx(0.8).margin(0.02));
}

TEST_CASE("A belt that sags tells by how much", "[calibrate]") {
  const Plane truth{-Vec3::UnitZ(), -700.0};
  std::vector<Vec3f> points = tilted_belt(truth, 0.0);
  for (Vec3f& point : points) {
    if (point.z() > 0.0F) point.z() += 0.3F * (point.x() / 100.0F) * (point.x() / 100.0F);
  }
  const RangeImage range{{points.data(), kRows, kCols}, {}, {}};
  const auto belt = fit_belt_plane(range, truth);
  REQUIRE(belt);
  CHECK(belt->bow_mm == Approx(0.3).margin(0.1));
}

TEST_CASE("A view without a belt is refused", "[calibrate]") {
  std::vector<Vec3f> points = tilted_belt(sample_belt(), 0.0);
  const RangeImage range{{points.data(), kRows, kCols}, {}, {}};
  const auto belt = fit_belt_plane(range, Plane{-Vec3::UnitZ(), -400.0});
  REQUIRE_FALSE(belt);
  CHECK(belt.error().code == ResultCode::kTooFewPoints);
}

TEST_CASE("A bare belt keeps the earlier frame's origin and direction, laid onto the plane", "[calibrate]") {
  const Plane truth = sample_belt();
  const BeltPose fresh = belt_frame_on(truth, {});
  CHECK((fresh.rotation * fresh.rotation.transpose() - Mat3::Identity()).norm() < 1e-12);
  CHECK(fresh.rotation.determinant() == Approx(1.0));
  const Vec3 middle_mm(0, 0, truth.offset_mm / truth.normal.z());
  CHECK((fresh * middle_mm).norm() < 1e-9);
  CHECK((fresh * Vec3(middle_mm - Vec3(0, 0, 50))).z() > 49.0);  // towards the camera is up

  BeltPose earlier = fresh;
  earlier.rotation = Eigen::AngleAxisd(0.4, Vec3::UnitZ()) * earlier.rotation;
  earlier.translation_mm += Vec3(30, -20, 1.5);
  const BeltPose kept = belt_frame_on(truth, earlier);
  CHECK((kept * middle_mm - Vec3(earlier * middle_mm - Vec3(0, 0, 1.5))).norm() < 1e-6);
  CHECK(rotation_between_rad(kept.rotation, earlier.rotation) < 1e-6);
  const Plane back = belt_plane_of(kept);
  CHECK(back.offset_mm == Approx(truth.offset_mm));
  CHECK((back.normal - truth.normal).norm() < 1e-9);
}

TEST_CASE("A plate on the belt gives origin, direction and the plane below it", "[calibrate]") {
  const auto T_camera_plate = test::sample_pose();
  const BeltPose T_belt_camera = belt_frame_from(T_camera_plate, 5.0);
  CHECK((T_belt_camera * (T_camera_plate * Vec3(0, 0, 5))).norm() < 1e-9);
  CHECK((T_belt_camera * (T_camera_plate * Vec3(100, 0, 0)) - Vec3(100, 0, 5)).norm() < 1e-9);
  CHECK((T_belt_camera * (T_camera_plate * Vec3(0, 40, 0)) - Vec3(0, -40, 5)).norm() < 1e-9);
  CHECK(T_belt_camera.rotation.determinant() == Approx(1.0));
}
