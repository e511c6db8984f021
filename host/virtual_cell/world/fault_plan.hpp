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
  ResultCode expected;  // what the appliance must say; kOk: it must not even notice
  ResultCode or_else;   // as true an answer, where two things see the same fault
};

// A missed trigger is seen by the trigger's strobe watch before the frame count tells.
inline constexpr auto kCellFaults = std::to_array<CellFaultEntry>({
    {CellFault::kLostPackets, "lost-packets", FaultBy::kDeviceBeforeStart, ResultCode::kOk, ResultCode::kOk},
    {CellFault::kLostFrame, "lost-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameMissing,
     ResultCode::kFrameMissing},
    {CellFault::kMissedTrigger, "missed-trigger", FaultBy::kDeviceBeforeStart, ResultCode::kCameraNotTriggered,
     ResultCode::kFrameMissing},
    {CellFault::kShortFrame, "short-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameIncomplete,
     ResultCode::kFrameIncomplete},
    {CellFault::kWrongSize, "wrong-size", FaultBy::kDeviceBeforeStart, ResultCode::kFrameWrongSize,
     ResultCode::kFrameWrongSize},
    {CellFault::kBlackFrame, "black-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameBlack,
     ResultCode::kFrameBlack},
    {CellFault::kDuplicateFrame, "duplicate-frame", FaultBy::kDeviceBeforeStart, ResultCode::kFrameDuplicated,
     ResultCode::kFrameDuplicated},
    {CellFault::kDeadCamera, "dead-camera", FaultBy::kDeviceWhileCapturing, ResultCode::kCameraLost,
     static_cast<ResultCode>(201)},
    {CellFault::kBeltMovesCapture, "belt-moves-capture", FaultBy::kPlc, ResultCode::kBeltMovedDuringCapture,
     static_cast<ResultCode>(206)},
    {CellFault::kBeltMovesOffer, "belt-moves-offer", FaultBy::kPlc, ResultCode::kBeltMovedDuringOffer,
     ResultCode::kBeltMovedDuringOffer},
    {CellFault::kRobotInView, "robot-in-view", FaultBy::kPlc, ResultCode::kRobotInView, ResultCode::kRobotInView},
    {CellFault::kFailedPick, "failed-pick", FaultBy::kPlc, ResultCode::kPickFailed, ResultCode::kPickFailed},
    {CellFault::kPlcSilent, "plc-silent", FaultBy::kPlc, ResultCode::kPlcSilent, ResultCode::kPlcSilent},
    {CellFault::kEmergencyStop, "e-stop", FaultBy::kPlc, ResultCode::kEmergencyStop, static_cast<ResultCode>(207)},
    {CellFault::kNoStrobe, "no-strobe", FaultBy::kDeviceWhileCapturing, static_cast<ResultCode>(201),
     static_cast<ResultCode>(201)},
    {CellFault::kStrobeStuck, "strobe-stuck", FaultBy::kDeviceWhileCapturing, static_cast<ResultCode>(204),
     static_cast<ResultCode>(204)},
    {CellFault::kTriggerCut, "trigger-cut", FaultBy::kDeviceWhileCapturing, ResultCode::kCameraNotTriggered,
     ResultCode::kCameraNotTriggered},
    {CellFault::kTriggerStuck, "trigger-stuck", FaultBy::kDeviceWhileCapturing, ResultCode::kTriggerLineStuck,
     ResultCode::kTriggerLineStuck},
    {CellFault::kLostAdvance, "lost-advance", FaultBy::kDeviceBeforeStart, ResultCode::kPatternRepeated,
     ResultCode::kPatternRepeated},
    {CellFault::kHungFirmware, "hung-firmware", FaultBy::kDeviceWhileCapturing, static_cast<ResultCode>(212),
     static_cast<ResultCode>(212)},
    {CellFault::kUartNoise, "uart-noise", FaultBy::kDeviceBeforeStart, ResultCode::kOk, ResultCode::kOk},
    {CellFault::kUartGarbled, "uart-garbled", FaultBy::kDeviceWhileCapturing, ResultCode::kTriggerLineNoisy,
     ResultCode::kTriggerLineNoisy},
    {CellFault::kUartCut, "uart-cut", FaultBy::kDeviceWhileCapturing, ResultCode::kTriggerLost,
     ResultCode::kTriggerLost},
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
