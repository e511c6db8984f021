#include "plc/register_image.hpp"

#include <bit>

namespace beltpick::plc {

namespace {

void put_float(InputImage to, std::uint16_t address, float value, WordOrder order) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto high = static_cast<std::uint16_t>(bits >> 16U);
  const auto low = static_cast<std::uint16_t>(bits & 0xFFFFU);
  to[address] = order == WordOrder::kHighFirst ? high : low;
  to[address + 1U] = order == WordOrder::kHighFirst ? low : high;
}

// x, y, z, qw, qx, qy, qz in consecutive Float32 from `address`.
void put_pose(InputImage to, std::uint16_t address, const RegisterPose& pose, WordOrder order) {
  for (const float value : pose.translation_mm) {
    put_float(to, address, value, order);
    address = static_cast<std::uint16_t>(address + 2U);
  }
  for (const float value : pose.rotation_wxyz) {
    put_float(to, address, value, order);
    address = static_cast<std::uint16_t>(address + 2U);
  }
}

void encode_offer(const PoseBlock& offer, WordOrder order, InputImage to) {
  to[register_address("pose_sequence_begin")] = offer.sequence;
  to[register_address("part_number")] = offer.part_number;
  to[register_address("pose_kind")] = offer.pose_kind;
  to[register_address("pose_frame")] = offer.pose_frame;
  put_pose(to, register_address("part_x_mm"), offer.part, order);
  put_pose(to, register_address("grasp_x_mm"), offer.grasp, order);
  put_float(to, register_address("grasp_opening_mm"), offer.grasp_opening_mm, order);
  put_float(to, register_address("score"), offer.score, order);
  to[register_address("grasp_number")] = offer.grasp_number;
  to[register_address("pose_sequence_end")] = offer.sequence;
}

static_assert(register_address("part_qz") == register_address("part_x_mm") + 12, "a pose is seven floats in a row");
static_assert(register_address("grasp_qz") == register_address("grasp_x_mm") + 12, "a pose is seven floats in a row");

}  // namespace

void encode(const ApplianceRegisters& from, WordOrder order, InputImage to) {
  encode_offer(from.offer, order, to);
  to[register_address("heartbeat")] = from.heartbeat;
  to[register_address("state")] = static_cast<std::uint16_t>(from.state);
  to[register_address("fault_code")] = static_cast<std::uint16_t>(from.fault_code);
  to[register_address("last_code")] = static_cast<std::uint16_t>(from.last_code);
  to[register_address("recipe")] = from.recipe;
  to[register_address("cycle")] = from.cycle;
  to[register_address("capture")] = from.capture;
  to[register_address("parts_left")] = from.parts_left;
  to[register_address("withheld")] = from.withheld;
  to[register_address("withheld_code")] = static_cast<std::uint16_t>(from.withheld_code);
  to[register_address("status")] = from.status_bits;
}

}  // namespace beltpick::plc
