// What the cycle asks of camera, trigger and pipeline: start, abort, and what came of it. The real one is VisionThread;
// tests stand in for it.
#pragma once

#include <cstdint>

#include "cycle/cycle.hpp"

namespace beltpick::app {

class Vision {
 public:
  virtual ~Vision() = default;

  // None of these blocks or allocates.
  virtual void start_capture(std::uint16_t capture) = 0;
  virtual void abort_capture(ResultCode why) = 0;
  virtual void start_processing(std::uint16_t capture) = 0;

  // Ends are told once each. The parts stay until the next start_capture().
  virtual cycle::CaptureOutcome take_capture_outcome() = 0;
  virtual cycle::LocateOutcome take_locate_outcome() = 0;

  // Neither capturing nor processing, nor still winding down.
  [[nodiscard]] virtual bool idle() const = 0;
  // Why a capture could not be made at this moment: kOk, or that of the lost device.
  [[nodiscard]] virtual ResultCode device_code() const = 0;
};

}  // namespace beltpick::app
