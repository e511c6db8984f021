// LineTrigger: drives projector and camera by GPIO lines of this PC, for a cell without the microcontroller. It runs
// the firmware's own sequencer (trigger_fw/core), so sequences, interlocks, refusals and faults are the same; only the
// clock is a thread's instead of a timer's.
//
// Its timing is looser: an edge comes when the thread runs, some ten microseconds late on an idle PC at real-time
// priority, milliseconds late on a loaded one without it. Late rises move all that follows, so an exposure is never cut
// short; a late fall makes it longer, and by more than `late_limit_us` ends the sequence with TIMER_LATE. The strobe's
// times are the kernel's own stamps. tests/bench/bench_line_trigger measures it.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "base/ring.hpp"
#include "capture/lines/cell_lines.hpp"
#include "capture/trigger_source.hpp"
#include "core/sequencer.hpp"

namespace beltpick::capture {

struct LineTriggerConfig {
  LineSpec camera;     // output: active as long as the exposure
  LineSpec projector;  // output: a pulse advances it
  LineSpec strobe;     // input: the camera's exposure
  LineSpec busy;       // output, may be left out: active during a sequence; its rise sets the projector to its start
  LineSpec fault;      // output, may be left out
  int late_limit_us = 500;
};

class LineTrigger : public TriggerSource {
 public:
  // `interlocks` must outlive it; its belt_stopped and emergency_stop end a sequence as the microcontroller's do.
  LineTrigger(const LineTriggerConfig& config, const CellLines& interlocks);
  ~LineTrigger() override;
  LineTrigger(const LineTrigger&) = delete;
  LineTrigger& operator=(const LineTrigger&) = delete;

  // Takes the lines; after the interlocks'. Errors: those of Gpio::request.
  Result<void> open(Gpio& gpio);

  // Without the lines it does nothing.
  void start() override;
  [[nodiscard]] bool connected() const override { return opened_ && !lost_ && interlocks_.inputs().known; }
  [[nodiscard]] Error last_error() const override;
  [[nodiscard]] bool tried() const override { return true; }
  [[nodiscard]] TriggerInputs inputs() const override;
  // What it can do; there is no firmware whose version it could tell.
  [[nodiscard]] std::optional<protocol::Identity> identity() const override;
  [[nodiscard]] protocol::StatusReport status() const override;
  Result<void> refresh_status() override;
  Result<std::uint16_t> arm(protocol::Arm sequence) override;
  Result<void> start_sequence(std::uint16_t arm_id) override;
  Result<void> abort() override;
  Result<void> clear() override;
  // Tells also that the caller lives: silence for the armed time is HOST_SILENT.
  std::optional<TriggerEvent> next_event() override;

  // The wired lines and their levels now.
  [[nodiscard]] std::vector<LineShown> show() const;

  // How late an edge came at worst since START of the last sequence.
  [[nodiscard]] int worst_late_us() const { return worst_late_us_; }

 private:
  void run();
  void wait();
  void take_inputs();
  void take_strobe();
  void serve_until(std::uint32_t now_ticks);
  void serve(std::uint32_t at_ticks);
  void drive();
  void drive_line(GpioLine* line, bool before, bool now);
  void hand_on_events();
  void push(const TriggerEvent& event);
  void wake() const;
  void lose(const Error& error);
  Result<void> answer(protocol::Refusal refusal, const char* what) const;
  [[nodiscard]] std::uint32_t board_ticks(std::int64_t at_us) const;
  [[nodiscard]] static std::uint8_t input_bits(const CellInputs& inputs);

  LineTriggerConfig config_;
  const CellLines& interlocks_;
  std::unique_ptr<GpioLine> camera_, projector_, strobe_, busy_, fault_;
  int wake_fd_ = -1;
  bool opened_ = false;
  std::atomic<bool> lost_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> host_spoke_{false};
  std::atomic<int> worst_late_us_{0};
  Ring<TriggerEvent, 256> events_;

  mutable std::mutex mutex_;  // guards what follows
  std::int64_t clock_zero_us_;
  core::Sequencer sequencer_;
  core::Outputs driven_;
  std::uint16_t next_arm_id_ = 1;
  Error error_;
  std::thread thread_;
};

}  // namespace beltpick::capture
