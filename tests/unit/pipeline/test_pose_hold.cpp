// How firmly a pose is held, told from the covariance of its alignment.
#include <catch2/catch.hpp>
#include <vector>

#include "base/units.hpp"
#include "pipeline/attempt.hpp"
#include "pipeline/pose_hold.hpp"

using namespace beltpick;
using namespace beltpick::pipeline;

namespace {

constexpr double kDiagonal_mm = 200.0;
constexpr double kFirm_rad = 2e-5, kFirm_mm = 0.002;

PartModel part() {
  PartModel model;
  model.diagonal_mm = kDiagonal_mm;
  model.centre_mm = {10.0, 20.0, 30.0};
  return model;
}

// All freedoms firm, turned by 90 degrees about z.
Alignment held() {
  Alignment alignment;
  alignment.T_camera_part.rotation = Eigen::AngleAxisd(kPi / 2, Vec3::UnitZ()).toRotationMatrix();
  alignment.T_camera_part.translation_mm = {0.0, 0.0, 700.0};
  alignment.covariance.setZero();
  alignment.covariance.diagonal().head<3>().setConstant(kFirm_rad * kFirm_rad);
  alignment.covariance.diagonal().tail<3>().setConstant(kFirm_mm * kFirm_mm);
  return alignment;
}

void loosen(Alignment& alignment, int freedom, double sigma) { alignment.covariance(freedom, freedom) = sigma * sigma; }

// Ends all round a square of 120 mm in the part's plane, found where they are but for a shift of the object.
std::vector<icp::OutlinePair> ends_shifted(const Alignment& alignment, const Vec3& object_mm) {
  constexpr double kHalf_mm = 60.0;
  std::vector<icp::OutlinePair> ends;
  for (int side = 0; side < 4; ++side) {
    const Mat3 turn = Eigen::AngleAxisd(side * kPi / 2, Vec3::UnitZ()).toRotationMatrix();
    for (double along_mm = -kHalf_mm; along_mm <= kHalf_mm; along_mm += 2.0) {
      const Vec3 on_part_mm = part().centre_mm + turn * Vec3(kHalf_mm, along_mm, 0.0);
      const Vec3 outward = turn * Vec3::UnitX();
      const Vec3 measured_mm = alignment.T_camera_part * on_part_mm + object_mm;
      ends.push_back({on_part_mm.cast<float>(), outward.cast<float>(), measured_mm.cast<float>()});
    }
  }
  return ends;
}

}  // namespace

TEST_CASE("a pose is determined while no freedom is too uncertain to grip by", "[hold]") {
  CHECK(determined(held(), part()));
  Alignment sliding = held();
  loosen(sliding, 4, 0.3);
  CHECK_FALSE(determined(sliding, part()));
  Alignment turning = held();
  loosen(turning, 1, rad_from_deg(0.5));
  CHECK_FALSE(determined(turning, part()));
}

TEST_CASE("turns about the axis of a body of revolution do not count", "[hold]") {
  PartModel pin = part();
  pin.revolution = true;
  pin.axis_direction = Vec3::UnitX();  // y in the camera frame
  Alignment alignment = held();
  loosen(alignment, 1, 1.0);
  CHECK(determined(alignment, pin));
  CHECK_FALSE(loosest_freedom(alignment, pin));
  loosen(alignment, 0, 1.0);
  CHECK_FALSE(determined(alignment, pin));
}

TEST_CASE("the loosest freedom moves the rim by a millimetre", "[hold]") {
  CHECK_FALSE(loosest_freedom(held(), part()));
  Alignment alignment = held();
  loosen(alignment, 2, 1e-3);
  const auto freedom = loosest_freedom(alignment, part());
  REQUIRE(freedom);
  CHECK(std::abs((*freedom)[2]) * kDiagonal_mm / 2 == Approx(1.0));
  CHECK(freedom->tail<3>().norm() < 1e-9);
}

TEST_CASE("the outline asks for the shift at which its ends lie", "[hold]") {
  Alignment alignment = held();
  for (const int freedom : {3, 4}) loosen(alignment, freedom, 0.04);
  loosen(alignment, 2, 1e-4);
  const PartModel sheet = part();
  CHECK(asked_shift_mm(alignment, sheet, ends_shifted(alignment, Vec3::Zero())) < 0.01);
  CHECK(asked_shift_mm(alignment, sheet, ends_shifted(alignment, Vec3(1.5, 0.0, 0.0))) == Approx(1.5).margin(0.1));
  CHECK(asked_shift_mm(alignment, sheet, {}) == 0.0);

  SECTION("a third of the ends are those of something else") {
    auto ends = ends_shifted(alignment, Vec3::Zero());
    for (std::size_t i = 0; i < ends.size(); i += 3) ends[i].measured_mm += 4.0F * Vec3f::UnitX();
    CHECK(asked_shift_mm(alignment, sheet, ends) < 0.5);
  }
  SECTION("what the surface holds is not asked about") {
    CHECK(asked_shift_mm(held(), sheet, ends_shifted(alignment, Vec3(1.5, 0.0, 0.0))) == 0.0);
    loosen(alignment, 2, 4e-4);      // it may slide along and turn,
    loosen(alignment, 4, kFirm_mm);  // and is held across
    CHECK(asked_shift_mm(alignment, sheet, ends_shifted(alignment, Vec3(0.0, 1.5, 0.0))) < 0.3);
    CHECK(asked_shift_mm(alignment, sheet, ends_shifted(alignment, Vec3(1.5, 0.0, 0.0))) == Approx(1.5).margin(0.1));
  }
}

TEST_CASE("a motion turns the part about its centre, then shifts it", "[hold]") {
  const auto before = held().T_camera_part;
  Motion motion = Motion::Zero();
  motion[2] = kPi / 2;
  motion[3] = 5.0;
  const auto after = moved(before, motion, part());
  const Vec3 centre_mm = part().centre_mm, beside_mm = centre_mm + Vec3(1.0, 0.0, 0.0);
  CHECK((after * centre_mm - before * centre_mm - Vec3(5.0, 0.0, 0.0)).norm() < 1e-9);
  CHECK((after * beside_mm - after * centre_mm - Vec3(-1.0, 0.0, 0.0)).norm() < 1e-9);
}
