#include <catch2/catch.hpp>

#include <array>
#include <cstring>
#include <set>

#include "plc/register_image.hpp"

using namespace beltpick;
using namespace beltpick::plc;

namespace {

float read_float(const std::array<std::uint16_t, kInputRegisters>& image, int address, bool low_first = false) {
  const std::uint32_t first = image[address], second = image[address + 1];
  const std::uint32_t bits = low_first ? (second << 16U) | first : (first << 16U) | second;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("the register table has no overlapping and no foreign addresses", "[registers]") {
  std::set<std::pair<RegisterBank, int>> used;
  for (const RegisterEntry& entry : kRegisters) {
    const int count = entry.type == RegisterType::kF32 ? 2 : 1;
    for (int i = 0; i < count; ++i) {
      INFO(entry.name);
      CHECK(used.insert({entry.bank, entry.address + i}).second);
      CHECK(entry.address + i < (entry.bank == RegisterBank::kHolding ? kHoldingRegisters : kInputRegisters));
    }
  }
}

TEST_CASE("every input register is encoded, floats in both word orders", "[registers]") {
  ApplianceRegisters from;
  from.heartbeat = 1;
  from.state = CellState::kOffering;
  from.status_bits = 8;
  from.fault_code = ResultCode::kFrameBlack;
  from.last_code = ResultCode::kFrameMissing;
  from.recipe = 6;
  from.cycle = 7;
  from.capture = 9;
  from.parts_left = 10;
  from.withheld = 11;
  from.withheld_code = ResultCode::kNoGrasp;
  from.offer = {.sequence = 77,
                .part_number = 2,
                .pose_kind = 1,
                .pose_frame = 3,
                .part = {{1.5F, 2.5F, 3.5F}, {0.5F, 0.25F, -0.25F, 0.125F}},
                .grasp = {{-1.5F, -2.5F, -3.5F}, {0.75F, 1.25F, 1.75F, 2.25F}},
                .grasp_opening_mm = 42.0F,
                .score = 0.875F,
                .grasp_number = 4};
  for (const auto order : {WordOrder::kHighFirst, WordOrder::kLowFirst}) {
    std::array<std::uint16_t, kInputRegisters> image{};
    encode(from, order, image);
    const bool low = order == WordOrder::kLowFirst;
    // The design's numbers, written out: the table is the promise.
    CHECK(image[0] == 1);
    CHECK(image[1] == 5);
    CHECK(image[2] == 8);
    CHECK(image[5] == 103);
    CHECK(image[6] == 100);
    CHECK(image[7] == 6);
    CHECK(image[8] == 7);
    CHECK(image[9] == 9);
    CHECK(image[10] == 10);
    CHECK(image[11] == 11);
    CHECK(image[12] == 158);
    CHECK((image[20] == 77 && image[57] == 77));
    CHECK((image[21] == 2 && image[22] == 1 && image[23] == 3 && image[56] == 4));
    CHECK(read_float(image, 24, low) == 1.5F);
    CHECK(read_float(image, 28, low) == 3.5F);
    CHECK(read_float(image, 30, low) == 0.5F);
    CHECK(read_float(image, 36, low) == 0.125F);
    CHECK(read_float(image, 38, low) == -1.5F);
    CHECK(read_float(image, 50, low) == 2.25F);
    CHECK(read_float(image, 52, low) == 42.0F);
    CHECK(read_float(image, 54, low) == 0.875F);
  }
}

TEST_CASE("a pose becomes a unit quaternion with w >= 0", "[registers]") {
  for (double angle = -3.1; angle < 3.2; angle += 0.3) {
    Pose<frame::Belt, frame::Part> pose;
    pose.rotation = Eigen::AngleAxisd(angle, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
    pose.translation_mm = {10, 20, 30};
    const RegisterPose block = register_pose(pose);
    const auto& q = block.rotation_wxyz;
    CHECK(q[0] >= 0.0F);
    const Eigen::Quaterniond back(q[0], q[1], q[2], q[3]);
    CHECK(rotation_between_rad(back.toRotationMatrix(), pose.rotation) < 1e-6);
    CHECK(block.translation_mm[2] == 30.0F);
  }
}
