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
};

struct CellFaultEntry {
  CellFault fault;
  std::string_view name;
  ResultCode expected;  // what the appliance must say; kOk: it must not even notice
  ResultCode or_else;   // as true an answer, where two things see the same fault
};

// A missed trigger is seen by the trigger's strobe watch (firmware fault 1) before the frame count tells.
inline constexpr auto kCellFaults = std::to_array<CellFaultEntry>({
    {CellFault::kLostPackets, "lost-packets", ResultCode::kOk, ResultCode::kOk},
    {CellFault::kLostFrame, "lost-frame", ResultCode::kFrameMissing, ResultCode::kFrameMissing},
    {CellFault::kMissedTrigger, "missed-trigger", static_cast<ResultCode>(201), ResultCode::kFrameMissing},
    {CellFault::kShortFrame, "short-frame", ResultCode::kFrameIncomplete, ResultCode::kFrameIncomplete},
    {CellFault::kWrongSize, "wrong-size", ResultCode::kFrameWrongSize, ResultCode::kFrameWrongSize},
    {CellFault::kBlackFrame, "black-frame", ResultCode::kFrameBlack, ResultCode::kFrameBlack},
    {CellFault::kDuplicateFrame, "duplicate-frame", ResultCode::kFrameDuplicated, ResultCode::kFrameDuplicated},
    {CellFault::kDeadCamera, "dead-camera", ResultCode::kCameraLost, static_cast<ResultCode>(201)},
    {CellFault::kBeltMovesCapture, "belt-moves-capture", ResultCode::kBeltMovedDuringCapture,
     static_cast<ResultCode>(206)},
    {CellFault::kBeltMovesOffer, "belt-moves-offer", ResultCode::kBeltMovedDuringOffer,
     ResultCode::kBeltMovedDuringOffer},
    {CellFault::kRobotInView, "robot-in-view", ResultCode::kRobotInView, ResultCode::kRobotInView},
    {CellFault::kFailedPick, "failed-pick", ResultCode::kPickFailed, ResultCode::kPickFailed},
    {CellFault::kPlcSilent, "plc-silent", ResultCode::kPlcSilent, ResultCode::kPlcSilent},
    {CellFault::kEmergencyStop, "e-stop", ResultCode::kEmergencyStop, static_cast<ResultCode>(207)},
});

const CellFaultEntry& fault_entry(CellFault fault);
std::string fault_names();  // "lost-packets, lost-frame, ..."

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
