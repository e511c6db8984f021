#include "core/sequencer.hpp"

namespace beltpick {
namespace core {

using protocol::Fault;
using protocol::Refusal;
using protocol::State;

namespace {
bool before(uint32_t a_us, uint32_t b_us) { return static_cast<int32_t>(a_us - b_us) < 0; }
}  // namespace

Sequencer::Sequencer(uint8_t inputs, uint32_t now_us, const BoardTiming& board)
    : board_(board), inputs_(inputs), inputs_us_(now_us) {
  if ((inputs & protocol::kInputEmergencyStop) != 0) raise(Fault::kEmergencyStop);
}

Refusal Sequencer::arm(const protocol::Arm& arm) {
  if (state_ == State::kFault) return Refusal::kFaultLatched;
  const bool same = plan_.arm_id == arm.arm_id;
  if (state_ == State::kArmed && same) return same_sequence(plan_, arm) ? Refusal::kNone : Refusal::kArmIdUsed;
  if (state_ == State::kRunning) return Refusal::kSequenceRunning;
  if (same || arm.arm_id == 0) return Refusal::kArmIdUsed;
  const Refusal refusal = judge(arm, board_);
  if (refusal != Refusal::kNone) return refusal;
  plan_ = arm;
  frames_done_ = 0;
  state_ = State::kArmed;
  outputs_ = Outputs();
  return Refusal::kNone;
}

Refusal Sequencer::start(uint16_t arm_id, uint32_t now_us) {
  if (state_ == State::kFault) return Refusal::kFaultLatched;
  if (arm_id != plan_.arm_id || state_ == State::kIdle) return Refusal::kNotArmed;
  if (state_ != State::kArmed) return Refusal::kNone;  // it runs already, or has run
  if ((inputs_ & protocol::kInputBeltStopped) == 0) return Refusal::kBeltNotStopped;
  if (strobe_level_) return Refusal::kStrobeActive;
  state_ = State::kRunning;
  outputs_.busy = true;
  start_us_ = now_us + board_.start_lead_us;
  host_spoke(now_us);
  strobe_ = Strobe::kNotDue;
  walk_.start(start_us_);
  on_time(now_us);
  return Refusal::kNone;
}

void Sequencer::abort() {
  if (state_ == State::kFault) return;
  state_ = State::kIdle;
  outputs_ = Outputs();
}

Refusal Sequencer::clear() {
  if ((inputs_ & protocol::kInputEmergencyStop) != 0) return Refusal::kEmergencyStopPressed;
  if (state_ != State::kFault) return Refusal::kNone;
  state_ = State::kIdle;
  fault_ = Fault::kNone;
  fault_frame_ = protocol::kNoFrame;
  outputs_ = Outputs();
  return Refusal::kNone;
}

void Sequencer::on_time(uint32_t now_us) {
  while (state_ == State::kRunning) {
    uint32_t at_us;
    const Awaited awaited = earliest(at_us);
    if (before(now_us, at_us)) return;
    if (awaited == Awaited::kHost) {
      raise(Fault::kHostSilent);
    } else if (awaited == Awaited::kStrobe) {
      raise(strobe_ == Strobe::kAwaited ? Fault::kStrobeMissing : Fault::kStrobeTooLong);
    } else if (now_us - at_us > board_.late_limit_us) {
      raise(Fault::kTimerLate);
    } else {
      serve_edge(at_us);
    }
  }
}

// At equal times the strobe goes first: its deadline belongs to the frame that an edge may end.
Sequencer::Awaited Sequencer::earliest(uint32_t& at_us) const {
  Awaited awaited = Awaited::kEdge;
  at_us = walk_.at_us();
  const bool strobe_due = strobe_ == Strobe::kAwaited || strobe_ == Strobe::kActive;
  if (strobe_due && !before(at_us, strobe_deadline_us_)) {
    awaited = Awaited::kStrobe;
    at_us = strobe_deadline_us_;
  }
  if (before(host_deadline_us_, at_us)) {
    awaited = Awaited::kHost;
    at_us = host_deadline_us_;
  }
  return awaited;
}

bool Sequencer::next_deadline(uint32_t& at_us) const {
  if (state_ != State::kRunning) return false;
  earliest(at_us);
  return true;
}

// Serves the output edge that is due at `at_us`.
void Sequencer::serve_edge(uint32_t at_us) {
  const Edge edge = walk_.edge();
  walk_.pass(plan_);
  switch (edge) {
    case Edge::kFrameBegins:
      frames_done_ = walk_.frame();
      strobe_ = Strobe::kNotDue;
      outputs_.projector = true;
      return;
    case Edge::kAdvanceFalls:
      outputs_.projector = false;
      return;
    case Edge::kPulseRises:
      outputs_.camera = true;
      ++trigger_number_;
      pulse_us_ = at_us;
      strobe_ = Strobe::kAwaited;
      strobe_deadline_us_ = at_us + plan_.strobe_tolerance_us;
      return;
    case Edge::kPulseFalls:
      outputs_.camera = false;
      return;
    case Edge::kSequenceEnds:
      ++frames_done_;
      finish(at_us);
      return;
  }
}

void Sequencer::finish(uint32_t at_us) {
  state_ = State::kDone;
  outputs_ = Outputs();
  outputs_.done = true;
  duration_us_ = at_us - start_us_;
  done_pending_ = true;
}

void Sequencer::on_strobe(bool active, uint32_t now_us) {
  on_time(now_us);
  if (active == strobe_level_) return;
  strobe_level_ = active;
  if (state_ != State::kRunning) return;
  if (active) {
    strobe_rose(now_us);
  } else if (strobe_ == Strobe::kActive) {
    strobe_fell(now_us);
  }
}

void Sequencer::strobe_rose(uint32_t now_us) {
  if (strobe_ != Strobe::kAwaited) {
    raise(strobe_ == Strobe::kNotDue ? Fault::kStrobeEarly : Fault::kStrobeDouble);
    return;
  }
  strobe_ = Strobe::kActive;
  strobe_start_us_ = now_us;
  strobe_deadline_us_ = pulse_us_ + timing().exposure_us + plan_.strobe_tolerance_us;
}

void Sequencer::strobe_fell(uint32_t now_us) {
  strobe_ = Strobe::kEnded;
  const uint32_t length_us = now_us - strobe_start_us_;
  if (length_us + plan_.strobe_tolerance_us < timing().exposure_us) {
    raise(Fault::kStrobeTooShort);
    return;
  }
  if (frames_count_ == kFrameQueue) {
    raise(Fault::kEventsLost);
    return;
  }
  protocol::FrameEvent& event = frames_[(frames_head_ + frames_count_++) % kFrameQueue];
  event.arm_id = plan_.arm_id;
  event.frame = walk_.frame();
  event.trigger_number = trigger_number_;
  event.pulse_us = pulse_us_ - start_us_;
  event.strobe_us = strobe_start_us_ - start_us_;
  event.strobe_length_us = length_us;
}

void Sequencer::on_inputs(uint8_t inputs, uint32_t now_us) {
  on_time(now_us);
  if (inputs == inputs_) return;
  inputs_ = inputs;
  inputs_us_ = now_us;
  inputs_pending_ = true;
  if ((inputs & protocol::kInputEmergencyStop) != 0) {
    raise(Fault::kEmergencyStop);
  } else if (state_ == State::kRunning && (inputs & protocol::kInputBeltStopped) == 0) {
    raise(Fault::kBeltMoved);
  }
}

void Sequencer::on_late_edge() {
  if (state_ == State::kRunning) raise(Fault::kTimerLate);
}

// The first fault stays: what follows it is its consequence.
void Sequencer::raise(Fault fault) {
  if (state_ == State::kFault) return;
  fault_frame_ = state_ == State::kRunning ? walk_.frame() : protocol::kNoFrame;
  fault_ = fault;
  state_ = State::kFault;
  outputs_ = Outputs();
  outputs_.fault = true;
  fault_pending_ = true;
}

protocol::StatusReport Sequencer::status(uint32_t now_us) const {
  protocol::StatusReport report;
  report.state = state_;
  report.fault = fault_;
  report.fault_frame = fault_frame_;
  report.arm_id = plan_.arm_id;
  report.frames_done = frames_done_;
  report.inputs = inputs_;
  report.trigger_number = trigger_number_;
  report.now_us = now_us;
  return report;
}

bool Sequencer::take(protocol::FrameEvent& event) {
  if (frames_count_ == 0) return false;
  event = frames_[frames_head_];
  frames_head_ = static_cast<uint8_t>((frames_head_ + 1) % kFrameQueue);
  --frames_count_;
  return true;
}

bool Sequencer::take(protocol::DoneEvent& event) {
  if (!done_pending_) return false;
  done_pending_ = false;
  event.arm_id = plan_.arm_id;
  event.frames = frames_done_;
  event.duration_us = duration_us_;
  return true;
}

bool Sequencer::take(protocol::FaultEvent& event) {
  if (!fault_pending_) return false;
  fault_pending_ = false;
  event.fault = fault_;
  event.frame = fault_frame_;
  event.arm_id = plan_.arm_id;
  return true;
}

bool Sequencer::take(protocol::InputsEvent& event) {
  if (!inputs_pending_) return false;
  inputs_pending_ = false;
  event.inputs = inputs_;
  event.now_us = inputs_us_;
  return true;
}

}  // namespace core
}  // namespace beltpick
