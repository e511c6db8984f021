// Sequencer: runs an armed sequence edge by edge, watches strobe, belt, emergency stop and host, and falls to safe
// outputs with a latched fault when one of them is wrong. Pure: the board gives it times and levels and copies its
// outputs to pins.
//
// Times are the board's ticks (core::kTick_ns); they wrap, and are compared within half their range. After every call
// the board applies outputs() and sets its timer to next_deadline().
#pragma once

#include "core/edge_walk.hpp"
#include "protocol/messages.hpp"

namespace beltpick {
namespace core {

struct Outputs {
  bool projector = false;  // advance pulse
  bool camera = false;     // trigger: high for the exposure
  bool busy = false;
  bool done = false;
  bool fault = false;
};

class Sequencer {
 public:
  // `inputs`: protocol::InputBit as the pins read at start. An emergency stop pressed then is a fault from the start,
  // as is what the start itself tells (`at_start`).
  Sequencer(uint8_t inputs, uint32_t now_ticks, const BoardTiming& board = BoardTiming(),
            protocol::Fault at_start = protocol::Fault::kNone);

  // Requests, as PROTOCOL.md has them.
  protocol::Refusal arm(const protocol::Arm& arm);
  protocol::Refusal start(uint16_t arm_id, uint32_t now_ticks);
  // The START pin: starts whatever is armed.
  protocol::Refusal start_by_pin(uint32_t now_ticks) { return start(plan_.arm_id, now_ticks); }
  void abort();
  protocol::Refusal clear();
  void host_spoke(uint32_t now_ticks) {
    host_deadline_ticks_ = now_ticks + ticks_of(uint32_t{1000} * plan_.host_silence_ms);
  }

  // What happens in the world.
  void on_time(uint32_t now_ticks);
  void on_strobe(bool active, uint32_t now_ticks);
  void on_inputs(uint8_t inputs, uint32_t now_ticks);
  // The board's timer could not drive an edge at its time.
  void on_late_edge();

  // When on_time() is to be called next; false when nothing is awaited.
  bool next_deadline(uint32_t& at_ticks) const;
  Outputs outputs() const { return outputs_; }
  protocol::StatusReport status(uint32_t now_ticks) const;

  // For a board whose timer drives the pins ahead: the sequence that runs, and when its first frame begins.
  bool running() const { return state_ == protocol::State::kRunning; }
  const protocol::Arm& plan() const { return plan_; }
  uint32_t start_ticks() const { return start_ticks_; }

  // Events for the wire, each given once. False when there is none.
  bool take(protocol::FrameEvent& event);
  bool take(protocol::DoneEvent& event);
  bool take(protocol::FaultEvent& event);
  bool take(protocol::InputsEvent& event);

 private:
  enum class Strobe : uint8_t { kNotDue, kAwaited, kActive, kEnded };
  enum class Awaited : uint8_t { kStrobe, kEdge, kHost };
  static constexpr uint8_t kFrameQueue = 4;

  Awaited earliest(uint32_t& at_ticks) const;
  void serve_edge(uint32_t at_ticks);
  void finish(uint32_t at_ticks);
  void strobe_rose(uint32_t now_ticks);
  void strobe_fell(uint32_t now_ticks);
  void raise(protocol::Fault fault);
  const protocol::Group& timing() const { return walk_.timing(plan_); }

  BoardTiming board_;

  protocol::State state_ = protocol::State::kIdle;
  protocol::Fault fault_ = protocol::Fault::kNone;
  uint16_t fault_frame_ = protocol::kNoFrame;
  Outputs outputs_;

  protocol::Arm plan_;
  EdgeWalk walk_;
  uint16_t frames_done_ = 0;
  uint32_t trigger_number_ = 0;
  uint32_t start_ticks_ = 0;

  Strobe strobe_ = Strobe::kNotDue;
  bool strobe_level_ = false;
  uint32_t pulse_ticks_ = 0;
  uint32_t strobe_start_ticks_ = 0;
  uint32_t strobe_deadline_ticks_ = 0;

  uint8_t inputs_;
  uint32_t inputs_ticks_;
  uint32_t host_deadline_ticks_ = 0;  // of the running sequence

  protocol::FrameEvent frames_[kFrameQueue];
  uint8_t frames_head_ = 0;
  uint8_t frames_count_ = 0;
  protocol::DoneEvent done_event_;    // as it was: the line may tell of it only after the next request
  protocol::FaultEvent fault_event_;  // likewise
  bool done_pending_ = false;
  bool fault_pending_ = false;
  bool inputs_pending_ = false;
};

}  // namespace core
}  // namespace beltpick
