#include "capture/trigger_source.hpp"

#include "contract/result_codes.hpp"

namespace beltpick::capture {

using protocol::Fault;
using protocol::Refusal;

ResultCode code_of(Fault fault) {
  if (fault == Fault::kBeltMoved) return ResultCode::kBeltMovedDuringCapture;
  if (fault == Fault::kEmergencyStop) return ResultCode::kEmergencyStop;
  return firmware_code(fault);
}

ResultCode code_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::kBeltNotStopped:
      return ResultCode::kBeltMovedDuringCapture;
    case Refusal::kEmergencyStopPressed:
      return ResultCode::kEmergencyStop;
    case Refusal::kNoFrames:
    case Refusal::kTooManyGroups:
    case Refusal::kTooManyFrames:
    case Refusal::kExposureOutOfRange:
    case Refusal::kSettleTooShort:
    case Refusal::kPeriodTooShort:
    case Refusal::kPeriodTooLong:
    case Refusal::kIntervalTooShort:
      return ResultCode::kValueOutOfRange;
    case Refusal::kStrobeActive:
      return code_of(Fault::kStrobeTooLong);
    case Refusal::kFlashDamaged:
      return code_of(Fault::kFlashDamaged);
    default:
      return ResultCode::kInternal;
  }
}

}  // namespace beltpick::capture
