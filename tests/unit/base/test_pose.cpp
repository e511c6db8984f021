#include <catch2/catch.hpp>

#include "base/pose.hpp"
#include "base/units.hpp"
#include "contract/registers.hpp"
#include "contract/result_codes.hpp"

using namespace beltpick;

TEST_CASE("a chained pose takes a point the same way as its links", "[pose]") {
  Pose<frame::Belt, frame::Camera> T_belt_camera{Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix(),
                                                 Vec3(10, -20, 700)};
  Pose<frame::Camera, frame::Part> T_camera_part{Eigen::AngleAxisd(-1.1, Vec3::UnitY()).toRotationMatrix(),
                                                 Vec3(1, 2, 3)};
  const Vec3 point_part_mm(4, 5, 6);
  const auto T_belt_part = T_belt_camera * T_camera_part;
  CHECK((T_belt_part * point_part_mm - T_belt_camera * (T_camera_part * point_part_mm)).norm() < 1e-12);
  CHECK((T_belt_part.inverse() * (T_belt_part * point_part_mm) - point_part_mm).norm() < 1e-12);
  CHECK(
      (Pose<frame::Belt, frame::Part>::from_matrix(T_belt_part.matrix()) * point_part_mm - T_belt_part * point_part_mm)
          .norm() < 1e-12);
}

TEST_CASE("the angle between rotations is the angle of the turn between them", "[pose]") {
  const Mat3 a = Eigen::AngleAxisd(0.3, Vec3::UnitX()).toRotationMatrix();
  const Mat3 b = a * Eigen::AngleAxisd(rad_from_deg(25), Vec3(1, 1, 0).normalized()).toRotationMatrix();
  CHECK(deg_from_rad(rotation_between_rad(a, b)) == Approx(25));
}

TEST_CASE("result codes and registers are each listed once", "[contract]") {
  for (std::size_t i = 0; i < kResultCodes.size(); ++i) {
    for (std::size_t j = i + 1; j < kResultCodes.size(); ++j) {
      CHECK(kResultCodes[i].code != kResultCodes[j].code);
      CHECK(kResultCodes[i].name != kResultCodes[j].name);
    }
  }
  for (const RegisterEntry& a : kRegisters) {
    const int words = a.type == RegisterType::kF32 ? 2 : 1;
    CHECK(a.address + words <= (a.bank == RegisterBank::kInput ? kInputRegisters : kHoldingRegisters));
    for (const RegisterEntry& b : kRegisters) {
      if (&a == &b || a.bank != b.bank) continue;
      CHECK((b.address < a.address || b.address >= a.address + words));
    }
  }
}
