// SteppedTrigger: a capture whose projector leads (a display at a connector): for every frame its page is shown first,
// and when the display has begun it and the projector's latency is over, the trigger runs a sequence of that one frame.
// To a capture it is one sequence, as any other trigger's.
//
// How the two are kept in step: the flip is confirmed by the display's own event, so a frame can come late but never be
// exposed with the page before it. The trigger's clock times only the pulse: from frame to frame the display's frame
// clock, the latency and the requests count, some 60 ms at 60 Hz, and the period that is armed is the least one.
//
// It has no thread: next_event() takes the steps, and blocks for up to a frame of the display while a page is flipped.
#pragma once

#include "capture/trigger_source.hpp"

namespace beltpick::capture {

class FrameShow {
 public:
  virtual ~FrameShow() = default;
  // Shows a frame of the sequence; returns when the display begins it: monotonic_us(). Allocates nothing.
  virtual Result<std::int64_t> show(int frame) = 0;
};

class SteppedTrigger : public TriggerSource {
 public:
  // `latency_us`: from the begin of a frame at the connector to its light.
  SteppedTrigger(TriggerSource& trigger, FrameShow& show, std::int64_t latency_us)
      : trigger_(trigger), show_(show), latency_us_(latency_us) {}

  void start() override { trigger_.start(); }
  [[nodiscard]] bool connected() const override { return trigger_.connected(); }
  [[nodiscard]] Error last_error() const override { return trigger_.last_error(); }
  [[nodiscard]] bool tried() const override { return trigger_.tried(); }
  [[nodiscard]] TriggerInputs inputs() const override { return trigger_.inputs(); }
  [[nodiscard]] std::optional<protocol::Identity> identity() const override { return trigger_.identity(); }
  // As if the whole sequence ran in one.
  [[nodiscard]] protocol::StatusReport status() const override;

  Result<void> refresh_status() override { return trigger_.refresh_status(); }
  Result<std::uint16_t> arm(protocol::Arm sequence) override;
  Result<void> start_sequence(std::uint16_t arm_id) override;
  Result<void> abort() override;
  Result<void> clear() override { return trigger_.clear(); }
  std::optional<TriggerEvent> next_event() override;
  // What show() failed with.
  [[nodiscard]] Result<void> going_on() const override { return going_on_; }

 private:
  enum class Step : std::uint8_t { kNone, kShow, kWait, kPulse, kDone };

  void show_page();
  void trigger_frame();
  std::optional<TriggerEvent> hand_on();
  [[nodiscard]] bool ended_unheard() const;
  std::optional<TriggerEvent> end_frame(std::uint32_t duration_ticks);
  [[nodiscard]] const protocol::Group& group_of(int frame) const;
  [[nodiscard]] int frames() const;

  TriggerSource& trigger_;
  FrameShow& show_;
  std::int64_t latency_us_;

  protocol::Arm sequence_;
  std::uint16_t arm_id_ = 0;  // of the whole
  Step step_ = Step::kNone;
  int frame_ = 0;
  std::uint16_t frame_arm_id_ = 0;  // of the frame that runs
  std::int64_t due_us_ = 0;         // when the page is lit
  std::int64_t first_us_ = 0, pulse_us_ = 0;
  std::int64_t least_next_us_ = 0;  // the period from frame to frame
  Result<void> going_on_;
};

}  // namespace beltpick::capture
