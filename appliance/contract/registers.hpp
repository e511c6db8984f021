// The PLC's view of the appliance: every Modbus register once. `beltpick registers` prints this table and a test holds
// the committed reference against it. Addresses are a promise: entries are added at the end of their block, never
// moved.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace beltpick {

enum class RegisterBank : std::uint8_t { kHolding, kInput };  // holding: the PLC writes; input: the appliance writes
enum class RegisterType : std::uint8_t { kU16, kBits, kF32 };

struct RegisterEntry {
  RegisterBank bank;
  std::uint16_t address;  // zero-based, as on the wire
  RegisterType type;      // kF32 takes two registers, high word first unless configured
  std::string_view name;
  std::string_view meaning;
};

// How a PLC drives a cycle. After power-up and after a cleared fault the cell is idle and keeps the belt ("belt may
// move" is low): start a cycle, or end one (5) to give the view up. A start waits up to signals_agree_ms for line and
// register to agree that the belt stands, for the robot to be clear, and for settle_ms; then it captures. While "pose
// valid" is high: pick, answer with 2, 3 or 4 and the offer's number, then look again: another offer, "capture wanted",
// or "belt may move". "Belt may move" stays until the next start. A fault latches until command 6 and needs its cause
// gone.
//
// Commands the PLC writes to `command`, echoed in `command_echo` when done or refused.
enum class PlcCommand : std::uint16_t {
  kNone = 0,
  kStartCycle = 1,  // belt stands, robot clear: capture and locate
  kPickDone = 2,    // argument: the offer's sequence number
  kPickFailed = 3,  // argument: the offer's sequence number
  kSkipPart = 4,    // argument: the offer's sequence number; the part is left for the tray
  kEndCycle = 5,    // give up what is left of this view
  kClearFault = 6,
  kSelectRecipe = 7,  // argument: recipe number
};

// Bits of holding register `plc_status`.
enum PlcStatusBit : std::uint16_t { kPlcBeltStopped = 1U << 0U, kPlcRobotClear = 1U << 1U };

// Bits of input register `status`.
enum ApplianceStatusBit : std::uint16_t {
  kStatusReady = 1U << 0U,      // a cycle may be started
  kStatusCapturing = 1U << 1U,  // belt must stand, robot must stay clear
  kStatusProcessing = 1U << 2U,
  kStatusPoseValid = 1U << 3U,      // the pose block may be used
  kStatusBeltMayMove = 1U << 4U,    // a permission; the PLC alone drives the belt
  kStatusFault = 1U << 5U,          // see fault_code; cleared by command 6
  kStatusCaptureWanted = 1U << 6U,  // clear the robot from the view: the next capture of this cycle waits for it
};

// Values of input register `state`.
enum class CellState : std::uint16_t {
  kStarting = 0,
  kIdle = 1,
  kSettling = 2,
  kCapturing = 3,
  kProcessing = 4,
  kOffering = 5,
  kBeltReleased = 6,
  kFault = 7,
};

inline constexpr auto kRegisters = std::to_array<RegisterEntry>({
    {RegisterBank::kHolding, 0, RegisterType::kU16, "command",
     "0 none, 1 start cycle, 2 pick done, 3 pick failed, 4 skip part, 5 end cycle, 6 clear fault, 7 select recipe; "
     "write 0 after the echo"},
    {RegisterBank::kHolding, 1, RegisterType::kU16, "command_argument",
     "offer sequence number for 2, 3, 4; recipe number for 7; written before the command"},
    {RegisterBank::kHolding, 2, RegisterType::kBits, "plc_status", "bit 0 belt stopped, bit 1 robot clear of the view"},
    {RegisterBank::kHolding, 3, RegisterType::kU16, "plc_heartbeat", "changes at least every half plc_timeout_ms"},
    {RegisterBank::kInput, 0, RegisterType::kU16, "heartbeat", "counts up every 100 ms"},
    {RegisterBank::kInput, 1, RegisterType::kU16, "state",
     "0 starting, 1 idle, 2 settling, 3 capturing, 4 processing, 5 offering, 6 belt released, 7 fault"},
    {RegisterBank::kInput, 2, RegisterType::kBits, "status",
     "bit 0 ready, 1 capturing, 2 processing, 3 pose valid, 4 belt may move, 5 fault, 6 capture wanted (clear the "
     "robot)"},
    {RegisterBank::kInput, 3, RegisterType::kU16, "command_echo",
     "the command that was done or refused; 0 after the PLC wrote 0"},
    {RegisterBank::kInput, 4, RegisterType::kU16, "command_result", "result code of the echoed command; 0 done"},
    {RegisterBank::kInput, 5, RegisterType::kU16, "fault_code", "result code of the latched fault; 0 none"},
    {RegisterBank::kInput, 6, RegisterType::kU16, "last_code",
     "result code of the last thing worth telling, e.g. why an offer was revoked"},
    {RegisterBank::kInput, 7, RegisterType::kU16, "recipe", "number of the active recipe"},
    {RegisterBank::kInput, 8, RegisterType::kU16, "cycle", "counts cycles, wraps"},
    {RegisterBank::kInput, 9, RegisterType::kU16, "capture", "counts captures, wraps"},
    {RegisterBank::kInput, 10, RegisterType::kU16, "parts_left",
     "verified parts of this view not yet picked, the offered one included"},
    {RegisterBank::kInput, 11, RegisterType::kU16, "withheld",
     "objects of this view that were not identified or cannot be gripped"},
    {RegisterBank::kInput, 12, RegisterType::kU16, "withheld_code", "result code of the first of them"},
    {RegisterBank::kInput, 20, RegisterType::kU16, "pose_sequence_begin",
     "offer sequence number; equal to pose_sequence_end when the block is whole"},
    {RegisterBank::kInput, 21, RegisterType::kU16, "part_number",
     "position of the part's template in the recipe, from 1"},
    {RegisterBank::kInput, 22, RegisterType::kU16, "pose_kind", "1 verified, 2 ambiguous by the part's symmetry"},
    {RegisterBank::kInput, 23, RegisterType::kU16, "pose_frame", "1 camera, 2 belt, 3 robot"},
    {RegisterBank::kInput, 24, RegisterType::kF32, "part_x_mm", "part pose: translation"},
    {RegisterBank::kInput, 26, RegisterType::kF32, "part_y_mm", ""},
    {RegisterBank::kInput, 28, RegisterType::kF32, "part_z_mm", ""},
    {RegisterBank::kInput, 30, RegisterType::kF32, "part_qw", "part pose: rotation, unit quaternion, qw >= 0"},
    {RegisterBank::kInput, 32, RegisterType::kF32, "part_qx", ""},
    {RegisterBank::kInput, 34, RegisterType::kF32, "part_qy", ""},
    {RegisterBank::kInput, 36, RegisterType::kF32, "part_qz", ""},
    {RegisterBank::kInput, 38, RegisterType::kF32, "grasp_x_mm", "gripper pose: translation"},
    {RegisterBank::kInput, 40, RegisterType::kF32, "grasp_y_mm", ""},
    {RegisterBank::kInput, 42, RegisterType::kF32, "grasp_z_mm", ""},
    {RegisterBank::kInput, 44, RegisterType::kF32, "grasp_qw",
     "gripper pose: rotation; gripper z is the way in, x the closing direction"},
    {RegisterBank::kInput, 46, RegisterType::kF32, "grasp_qx", ""},
    {RegisterBank::kInput, 48, RegisterType::kF32, "grasp_qy", ""},
    {RegisterBank::kInput, 50, RegisterType::kF32, "grasp_qz", ""},
    {RegisterBank::kInput, 52, RegisterType::kF32, "grasp_opening_mm", "between the jaws on the way in"},
    {RegisterBank::kInput, 54, RegisterType::kF32, "score", "0..1"},
    {RegisterBank::kInput, 56, RegisterType::kU16, "grasp_number", "position of the grasp in the template, from 1"},
    {RegisterBank::kInput, 57, RegisterType::kU16, "pose_sequence_end", "see pose_sequence_begin"},
});

// Sizes of the two banks, in registers.
inline constexpr std::uint16_t kHoldingRegisters = 16;
inline constexpr std::uint16_t kInputRegisters = 64;

// The address of a register by name; a name that does not exist does not compile.
consteval std::uint16_t register_address(std::string_view name) {
  for (const RegisterEntry& entry : kRegisters) {
    if (entry.name == name) return entry.address;
  }
  throw "no register of that name";
}

}  // namespace beltpick
