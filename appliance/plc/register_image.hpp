// The input registers as typed values, and their form on the wire. The addresses come from contract/registers.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/pose.hpp"
#include "contract/registers.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::plc {

enum class WordOrder : std::uint8_t { kHighFirst, kLowFirst };  // of a Float32's two registers

struct RegisterPose {
  std::array<float, 3> translation_mm{};
  std::array<float, 4> rotation_wxyz{};  // unit quaternion, w >= 0
};

template <class To, class From>
RegisterPose register_pose(const Pose<To, From>& pose) {
  Eigen::Quaterniond turn(pose.rotation);
  turn.normalize();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  const Vec3f t = pose.translation_mm.template cast<float>();
  const Eigen::Quaternionf q = turn.template cast<float>();
  return {{t.x(), t.y(), t.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

// What is offered; all zero when nothing is.
struct PoseBlock {
  std::uint16_t sequence = 0;
  std::uint16_t part_number = 0;
  std::uint16_t pose_kind = 0;   // 1 verified, 2 ambiguous
  std::uint16_t pose_frame = 0;  // 1 camera, 2 belt, 3 robot
  RegisterPose part;
  RegisterPose grasp;
  float grasp_opening_mm = 0.0F;
  float score = 0.0F;
  std::uint16_t grasp_number = 0;
};

struct ApplianceRegisters {
  std::uint16_t heartbeat = 0;
  CellState state = CellState::kStarting;
  std::uint16_t status_bits = 0;
  ResultCode fault_code = ResultCode::kOk;
  ResultCode last_code = ResultCode::kOk;
  std::uint16_t recipe = 0;
  std::uint16_t cycle = 0;
  std::uint16_t capture = 0;
  std::uint16_t parts_left = 0;
  std::uint16_t withheld = 0;
  ResultCode withheld_code = ResultCode::kOk;
  PoseBlock offer;
};

using InputImage = std::span<std::uint16_t, kInputRegisters>;

// Writes all input registers except the command's echo and result, which the handshake owns; the pose block before the
// status word with its valid flag.
void encode(const ApplianceRegisters& from, WordOrder order, InputImage to);

}  // namespace beltpick::plc
