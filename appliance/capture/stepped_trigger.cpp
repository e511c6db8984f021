#include "capture/stepped_trigger.hpp"

#include <algorithm>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "core/plan.hpp"

namespace beltpick::capture {

using protocol::State;
using protocol::Type;

namespace {

std::uint32_t ticks(std::int64_t time_us) { return static_cast<std::uint32_t>(time_us * 1000 / core::kTick_ns); }

}  // namespace

const protocol::Group& SteppedTrigger::group_of(int frame) const {
  std::uint8_t i = 0;
  while (frame >= sequence_.groups[i].frames) frame -= sequence_.groups[i++].frames;
  return sequence_.groups[i];
}

int SteppedTrigger::frames() const {
  int sum = 0;
  for (std::uint8_t i = 0; i < sequence_.group_count; ++i) sum += sequence_.groups[i].frames;
  return sum;
}

protocol::StatusReport SteppedTrigger::status() const {
  protocol::StatusReport status = trigger_.status();
  if (step_ == Step::kNone) return status;
  const bool of_a_frame = status.arm_id == frame_arm_id_ || status.arm_id == arm_id_;
  if (!of_a_frame) return status;
  status.arm_id = arm_id_;
  status.frames_done = static_cast<std::uint16_t>(frame_);
  if (status.state == State::kFault) {
    if (status.fault_frame != protocol::kNoFrame) status.fault_frame = static_cast<std::uint16_t>(frame_);
  } else {
    status.state = step_ == Step::kDone ? State::kDone : State::kRunning;
  }
  return status;
}

// Arming the whole lets the trigger judge it.
Result<std::uint16_t> SteppedTrigger::arm(protocol::Arm sequence) {
  step_ = Step::kNone;
  going_on_ = {};
  const auto armed = trigger_.arm(sequence);
  if (!armed) return armed;
  sequence_ = sequence;
  arm_id_ = *armed;
  return armed;
}

Result<void> SteppedTrigger::start_sequence(std::uint16_t arm_id) {
  if (arm_id != arm_id_ || arm_id_ == 0) {
    return failure(ResultCode::kInternal, "trigger: expected the start of arm id %u, found %u", arm_id_, arm_id);
  }
  frame_ = 0;
  frame_arm_id_ = arm_id_;
  first_us_ = least_next_us_ = 0;
  step_ = Step::kShow;
  return {};
}

Result<void> SteppedTrigger::abort() {
  step_ = Step::kNone;
  return trigger_.abort();
}

std::optional<TriggerEvent> SteppedTrigger::next_event() {
  if (step_ == Step::kNone || step_ == Step::kDone) return trigger_.next_event();
  if (step_ == Step::kShow) show_page();
  if (step_ == Step::kWait && monotonic_us() >= std::max(due_us_, least_next_us_)) trigger_frame();
  return hand_on();
}

void SteppedTrigger::show_page() {
  const auto begun_us = show_.show(frame_);
  if (!begun_us) {
    going_on_ = std::unexpected(begun_us.error());
    step_ = Step::kNone;
    return;
  }
  due_us_ = *begun_us + latency_us_;
  step_ = Step::kWait;
}

void SteppedTrigger::trigger_frame() {
  protocol::Arm one = sequence_;
  one.group_count = 1;
  one.groups[0] = group_of(frame_);
  one.groups[0].frames = 1;
  const auto armed = trigger_.arm(one);
  going_on_ = armed ? trigger_.start_sequence(*armed) : std::unexpected(armed.error());
  step_ = going_on_ ? Step::kPulse : Step::kNone;
  if (!going_on_) return;
  frame_arm_id_ = *armed;
  pulse_us_ = monotonic_us();
  if (frame_ == 0) first_us_ = pulse_us_;
  least_next_us_ = pulse_us_ + one.groups[0].period_us;
}

// Of the frame's sequence as of the whole. The measured times count from the first frame; where a frame begins is only
// known as well as this PC's clock and the requests tell it.
std::optional<TriggerEvent> SteppedTrigger::hand_on() {
  std::optional<TriggerEvent> event = trigger_.next_event();
  if (!event) return ended_unheard() ? end_frame(ticks(monotonic_us() - pulse_us_)) : std::nullopt;
  if (event->type == Type::kFaultEvent) {
    if (event->fault.frame != protocol::kNoFrame) event->fault.frame = static_cast<std::uint16_t>(frame_);
    event->fault.arm_id = arm_id_;
    return event;
  }
  if (event->type == Type::kFrameEvent && event->frame.arm_id == frame_arm_id_) {
    const std::uint32_t since_first = ticks(pulse_us_ - first_us_);
    event->frame.arm_id = arm_id_;
    event->frame.frame = static_cast<std::uint16_t>(frame_);
    event->frame.pulse_ticks += since_first;
    event->frame.strobe_ticks += since_first;
    return event;
  }
  const bool frame_done = event->type == Type::kDoneEvent && event->done.arm_id == frame_arm_id_;
  return frame_done ? end_frame(event->done.duration_ticks) : std::nullopt;
}

// An event that the wire lost still stands in the status.
bool SteppedTrigger::ended_unheard() const {
  const protocol::StatusReport status = trigger_.status();
  return step_ == Step::kPulse && status.arm_id == frame_arm_id_ && status.state == State::kDone;
}

std::optional<TriggerEvent> SteppedTrigger::end_frame(std::uint32_t duration_ticks) {
  const bool last = ++frame_ == frames();
  step_ = last ? Step::kDone : Step::kShow;
  if (!last) return std::nullopt;
  TriggerEvent done;
  done.type = Type::kDoneEvent;
  done.done = {arm_id_, static_cast<std::uint16_t>(frame_), ticks(pulse_us_ - first_us_) + duration_ticks};
  return done;
}

}  // namespace beltpick::capture
