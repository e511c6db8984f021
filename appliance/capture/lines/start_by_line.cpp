#include "capture/lines/start_by_line.hpp"

#include <chrono>
#include <thread>

#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {
constexpr int kBusyPatience_ms = 50;
}

// The pin tells no reason for a refusal: the interlocks are asked before.
Result<void> StartByLine::start_sequence(std::uint16_t arm_id) {
  if (!lines_.has_start()) return link_.start_sequence(arm_id);
  const TriggerInputs inputs = link_.inputs();
  if (inputs.emergency_stop) return failure(ResultCode::kEmergencyStop, "START: the emergency stop is pressed");
  if (!inputs.belt_stopped) {
    return failure(ResultCode::kBeltMovedDuringCapture, "START: the belt-stopped input is not active");
  }
  const unsigned rises_before = lines_.inputs().busy_rises;
  if (const auto pulsed = lines_.pulse_start(); !pulsed) return pulsed;
  if (!lines_.has_busy()) return {};
  for (int waited_ms = 0; waited_ms < kBusyPatience_ms; ++waited_ms) {
    if (lines_.inputs().busy_rises != rises_before) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return failure(ResultCode::kLinesLost,
                 "lines.start: expected BUSY to rise after the pulse, found it low for %d ms; check the wires of START "
                 "and BUSY",
                 kBusyPatience_ms);
}

}  // namespace beltpick::capture
