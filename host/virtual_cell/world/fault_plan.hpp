// FaultPlan: which fault hits which cycle of the virtual cell, by seed or by name.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/random.hpp"
#include "base/result.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {

enum class CellFault : std::uint8_t {
  kLostPackets,
  kLostFrame,
  kMissedTrigger,
  kShortFrame,
  kWrongSize,
  kBlackFrame,
  kDuplicateFrame,
  kDeadCamera,
  kBeltMovesCapture,
  kBeltMovesOffer,
  kRobotInView,
  kFailedPick,
  kPlcSilent,
  kEmergencyStop,
  kNoStrobe,
  kStrobeStuck,
  kTriggerCut,
  kTriggerStuck,
  kLostAdvance,
  kHungFirmware,
  kUartNoise,
  kUartGarbled,
  kUartCut,
};

// Who does it to the cell, and when.
enum class FaultBy : std::uint8_t {
  kDeviceBeforeStart,     // a device or a wire, before the cycle starts
  kDeviceWhileCapturing,  // or in the midst of the capture
  kPlc,                   // the PLC's program, by what it does itself
};

struct CellFaultEntry {
  CellFault fault;
  std::string_view name;
  FaultBy by;
  ResultCode expected;                // what the appliance must say; kOk: it must not even notice
  std::optional<ResultCode> or_else;  // as true an answer, where two things see the same fault
};

// A missed trigger is seen by the trigger's strobe watch before the frame count tells.
inline constexpr auto kCellFaults = std::to_array<CellFaultEntry>({
    {CellFault::kLostPackets, "lost-packets", FaultBy::kDeviceBeforeStart, ResultCode::kOk, {}},
    {CellFault::kLostFrame, "lost-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameMissing, {}},
    {CellFault::kMissedTrigger, "missed-trigger", FaultBy::kDeviceBeforeStart, ResultCode::kCameraNotTriggered,
     ResultCode::kFrameMissing},
    {CellFault::kShortFrame, "short-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameIncomplete, {}},
    {CellFault::kWrongSize, "wrong-size", FaultBy::kDeviceBeforeStart, ResultCode::kFrameWrongSize, {}},
    {CellFault::kBlackFrame, "black-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameBlack, {}},
    {CellFault::kDuplicateFrame, "duplicate-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameDuplicated, {}},
    {CellFault::kDeadCamera, "dead-camera", FaultBy::kDeviceWhileCapturing, ResultCode::kCameraLost,
     firmware_code(protocol::Fault::kStrobeMissing)},
    {CellFault::kBeltMovesCapture, "belt-moves-capture", FaultBy::kPlc, ResultCode::kBeltMovedDuringCapture,
     firmware_code(protocol::Fault::kBeltMoved)},
    {CellFault::kBeltMovesOffer, "belt-moves-offer", FaultBy::kPlc, ResultCode::kBeltMovedDuringOffer, {}},
    {CellFault::kRobotInView, "robot-in-view", FaultBy::kPlc, ResultCode::kRobotInView, {}},
    {CellFault::kFailedPick, "failed-pick", FaultBy::kPlc, ResultCode::kPickFailed, {}},
    {CellFault::kPlcSilent, "plc-silent", FaultBy::kPlc, ResultCode::kPlcSilent, {}},
    {CellFault::kEmergencyStop, "e-stop", FaultBy::kPlc, ResultCode::kEmergencyStop,
     firmware_code(protocol::Fault::kEmergencyStop)},
    {CellFault::kNoStrobe,
     "no-strobe",
     FaultBy::kDeviceWhileCapturing,
     firmware_code(protocol::Fault::kStrobeMissing),
     {}},
    {CellFault::kStrobeStuck,
     "strobe-stuck",
     FaultBy::kDeviceWhileCapturing,
     firmware_code(protocol::Fault::kStrobeTooLong),
     {}},
    {CellFault::kTriggerCut, "trigger-cut", FaultBy::kDeviceWhileCapturing, ResultCode::kCameraNotTriggered, {}},
    {CellFault::kTriggerStuck, "trigger-stuck", FaultBy::kDeviceWhileCapturing, ResultCode::kTriggerLineStuck, {}},
    {CellFault::kLostAdvance, "lost-advance", FaultBy::kDeviceBeforeStart, ResultCode::kPatternRepeated, {}},
    {CellFault::kHungFirmware,
     "hung-firmware",
     FaultBy::kDeviceWhileCapturing,
     firmware_code(protocol::Fault::kWatchdogReset),
     {}},
    {CellFault::kUartNoise, "uart-noise", FaultBy::kDeviceBeforeStart, ResultCode::kOk, {}},
    {CellFault::kUartGarbled, "uart-garbled", FaultBy::kDeviceWhileCapturing, ResultCode::kTriggerLineNoisy, {}},
    {CellFault::kUartCut, "uart-cut", FaultBy::kDeviceWhileCapturing, ResultCode::kTriggerLost, {}},
});

const CellFaultEntry& fault_entry(CellFault fault);
std::string fault_names();                                // "lost-packets, lost-frame, ..."
const CellFaultEntry* find_fault(std::string_view name);  // null: there is none of that name

class FaultPlan {
 public:
  FaultPlan() = default;
  // Each cycle is hit with probability `rate` in [0, 1] by a fault drawn evenly.
  FaultPlan(double rate, std::uint64_t seed) : rate_(rate), random_(seed, 0xfa) {}

  // "NAME" (first cycle) or "NAME@CYCLE" (from 0). kUsage names the faults that there are.
  Result<void> add(std::string_view text);

  std::optional<CellFault> for_cycle(int cycle);

 private:
  double rate_ = 0.0;
  Random random_{0};
  std::map<int, CellFault> named_;
};

}  // namespace beltpick::virtual_cell
