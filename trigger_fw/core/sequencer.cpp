#include "core/sequencer.hpp"

namespace beltpick {
namespace core {

using protocol::Fault;
using protocol::Refusal;
using protocol::State;

namespace {
bool before(uint32_t a_ticks, uint32_t b_ticks) { return static_cast<int32_t>(a_ticks - b_ticks) < 0; }
}  // namespace

Sequencer::Sequencer(uint8_t inputs, uint32_t now_ticks, const BoardTiming& board, Fault at_start)
    : board_(board), inputs_(inputs), inputs_ticks_(now_ticks) {
  if (at_start != Fault::kNone) raise(at_start);
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

Refusal Sequencer::start(uint16_t arm_id, uint32_t now_ticks) {
  if (state_ == State::kFault) return Refusal::kFaultLatched;
  if (arm_id != plan_.arm_id || state_ == State::kIdle) return Refusal::kNotArmed;
  if (state_ != State::kArmed) return Refusal::kNone;  // it runs already, or has run
  if ((inputs_ & protocol::kInputBeltStopped) == 0) return Refusal::kBeltNotStopped;
  if (strobe_level_) return Refusal::kStrobeActive;
  state_ = State::kRunning;
  outputs_.busy = true;
  start_ticks_ = now_ticks + ticks_of(board_.start_lead_us);
  host_spoke(now_ticks);
  strobe_ = Strobe::kNotDue;
  walk_.start(start_ticks_);
  on_time(now_ticks);
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
  if (fault_ == Fault::kFlashDamaged) return Refusal::kFlashDamaged;
  state_ = State::kIdle;
  fault_ = Fault::kNone;
  fault_frame_ = protocol::kNoFrame;
  outputs_ = Outputs();
  return Refusal::kNone;
}

void Sequencer::on_time(uint32_t now_ticks) {
  while (state_ == State::kRunning) {
    uint32_t at_ticks;
    const Awaited awaited = earliest(at_ticks);
    if (before(now_ticks, at_ticks)) return;
    if (awaited == Awaited::kHost) {
      raise(Fault::kHostSilent);
    } else if (awaited == Awaited::kStrobe) {
      raise(strobe_ == Strobe::kAwaited ? Fault::kStrobeMissing : Fault::kStrobeTooLong);
    } else if (now_ticks - at_ticks > ticks_of(board_.late_limit_us)) {
      raise(Fault::kTimerLate);
    } else {
      serve_edge(at_ticks);
    }
  }
}

// At equal times the strobe goes first: its deadline belongs to the frame that an edge may end.
Sequencer::Awaited Sequencer::earliest(uint32_t& at_ticks) const {
  Awaited awaited = Awaited::kEdge;
  at_ticks = walk_.at_ticks();
  const bool strobe_due = strobe_ == Strobe::kAwaited || strobe_ == Strobe::kActive;
  if (strobe_due && !before(at_ticks, strobe_deadline_ticks_)) {
    awaited = Awaited::kStrobe;
    at_ticks = strobe_deadline_ticks_;
  }
  if (before(host_deadline_ticks_, at_ticks)) {
    awaited = Awaited::kHost;
    at_ticks = host_deadline_ticks_;
  }
  return awaited;
}

bool Sequencer::next_deadline(uint32_t& at_ticks) const {
  if (state_ != State::kRunning) return false;
  earliest(at_ticks);
  return true;
}

// Serves the output edge that is due at `at_ticks`.
void Sequencer::serve_edge(uint32_t at_ticks) {
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
      pulse_ticks_ = at_ticks;
      strobe_ = Strobe::kAwaited;
      strobe_deadline_ticks_ = at_ticks + ticks_of(plan_.strobe_tolerance_us);
      return;
    case Edge::kPulseFalls:
      outputs_.camera = false;
      return;
    case Edge::kSequenceEnds:
      ++frames_done_;
      finish(at_ticks);
      return;
  }
}

void Sequencer::finish(uint32_t at_ticks) {
  state_ = State::kDone;
  outputs_ = Outputs();
  outputs_.done = true;
  done_event_.arm_id = plan_.arm_id;
  done_event_.frames = frames_done_;
  done_event_.duration_ticks = at_ticks - start_ticks_;
  done_pending_ = true;
}

void Sequencer::on_strobe(bool active, uint32_t now_ticks) {
  on_time(now_ticks);
  if (active == strobe_level_) return;
  strobe_level_ = active;
  if (state_ != State::kRunning) return;
  if (active) {
    strobe_rose(now_ticks);
  } else if (strobe_ == Strobe::kActive) {
    strobe_fell(now_ticks);
  }
}

void Sequencer::strobe_rose(uint32_t now_ticks) {
  if (strobe_ != Strobe::kAwaited) {
    raise(strobe_ == Strobe::kNotDue ? Fault::kStrobeEarly : Fault::kStrobeDouble);
    return;
  }
  strobe_ = Strobe::kActive;
  strobe_start_ticks_ = now_ticks;
  strobe_deadline_ticks_ = pulse_ticks_ + ticks_of(timing().exposure_us + plan_.strobe_tolerance_us);
}

void Sequencer::strobe_fell(uint32_t now_ticks) {
  strobe_ = Strobe::kEnded;
  const uint32_t length_ticks = now_ticks - strobe_start_ticks_;
  if (length_ticks + ticks_of(plan_.strobe_tolerance_us) < ticks_of(timing().exposure_us)) {
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
  event.pulse_ticks = pulse_ticks_ - start_ticks_;
  event.strobe_ticks = strobe_start_ticks_ - start_ticks_;
  event.strobe_length_ticks = length_ticks;
}

void Sequencer::on_inputs(uint8_t inputs, uint32_t now_ticks) {
  on_time(now_ticks);
  if (inputs == inputs_) return;
  inputs_ = inputs;
  inputs_ticks_ = now_ticks;
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
  fault_event_.fault = fault;
  fault_event_.frame = fault_frame_;
  fault_event_.arm_id = plan_.arm_id;
  fault_pending_ = true;
}

protocol::StatusReport Sequencer::status(uint32_t now_ticks) const {
  protocol::StatusReport report;
  report.state = state_;
  report.fault = fault_;
  report.fault_frame = fault_frame_;
  report.arm_id = plan_.arm_id;
  report.frames_done = frames_done_;
  report.inputs = inputs_;
  report.trigger_number = trigger_number_;
  report.now_ticks = now_ticks;
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
  event = done_event_;
  return true;
}

bool Sequencer::take(protocol::FaultEvent& event) {
  if (!fault_pending_) return false;
  fault_pending_ = false;
  event = fault_event_;
  return true;
}

bool Sequencer::take(protocol::InputsEvent& event) {
  if (!inputs_pending_) return false;
  inputs_pending_ = false;
  event.inputs = inputs_;
  event.now_ticks = inputs_ticks_;
  return true;
}

}  // namespace core
}  // namespace beltpick
