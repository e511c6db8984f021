// TriggerSource: whatever arms a sequence, drives projector and camera with it, and watches the camera's strobe: the
// microcontroller (TriggerLink), or lines of this PC (lines/line_trigger.hpp).
//
// Requests may block their caller for some 100 ms at worst per try and may come from any one thread at a time; events
// are for one consumer.
#pragma once

#include <cstdint>
#include <optional>

#include "base/result.hpp"
#include "protocol/messages.hpp"

namespace beltpick::capture {

// The interlock inputs of the source. Not known means not safe: belt_stopped is false then.
struct TriggerInputs {
  bool known = false;
  bool belt_stopped = false;
  bool emergency_stop = false;
  std::int64_t changed_us = 0;  // monotonic_us() when we heard of the last change
};

struct TriggerEvent {
  protocol::Type type = protocol::Type::kFrameEvent;  // kFrameEvent, kDoneEvent or kFaultEvent
  protocol::FrameEvent frame;
  protocol::DoneEvent done;
  protocol::FaultEvent fault;
};

// The appliance's code for a fault of the source: 200 + n, except for what the register table names itself (belt moved,
// emergency stop).
ResultCode code_of(protocol::Fault fault);
// And for what it refuses.
ResultCode code_of(protocol::Refusal refusal);

class TriggerSource {
 public:
  virtual ~TriggerSource() = default;

  // Starts its thread; returns at once.
  virtual void start() = 0;

  // True while it can be used.
  [[nodiscard]] virtual bool connected() const = 0;
  // Why it is not: kTriggerLost or kTriggerLineNoisy with the reason.
  [[nodiscard]] virtual Error last_error() const = 0;
  // True once it is known whether it can be used.
  [[nodiscard]] virtual bool tried() const = 0;
  [[nodiscard]] virtual TriggerInputs inputs() const = 0;
  // The firmware found last; nothing before, or where there is none.
  [[nodiscard]] virtual std::optional<protocol::Identity> identity() const = 0;
  // The latest STATUS.
  [[nodiscard]] virtual protocol::StatusReport status() const = 0;

  // Asks for a STATUS and waits for it: status() is then of now.
  virtual Result<void> refresh_status() = 0;
  // Arms the sequence under a new id, which is returned. kValueOutOfRange where it cannot be run.
  virtual Result<std::uint16_t> arm(protocol::Arm sequence) = 0;
  // kBeltMovedDuringCapture or kEmergencyStop when the interlocks forbid it.
  virtual Result<void> start_sequence(std::uint16_t arm_id) = 0;
  virtual Result<void> abort() = 0;
  // Ends a latched fault. kEmergencyStop while that is pressed.
  virtual Result<void> clear() = 0;

  // What keeps a running sequence from going on besides a fault; the next arm() forgets it.
  [[nodiscard]] virtual Result<void> going_on() const { return {}; }

  // The events of the running sequence, in order. Those of an older arm id are the caller's to skip.
  virtual std::optional<TriggerEvent> next_event() = 0;
};

}  // namespace beltpick::capture
