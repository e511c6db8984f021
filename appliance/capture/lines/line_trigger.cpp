#include "capture/lines/line_trigger.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

#include "base/clock.hpp"
#include "base/thread_priority.hpp"
#include "capture/lines/wake_event.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

using protocol::Refusal;
using protocol::Type;

namespace {

constexpr std::int64_t kSpin_us = 150;  // before an edge: waking up is later than that now and then
constexpr std::int64_t kIdle_us = 100'000;

// Lateness is judged here, where it is known of which edge. The limits keep the thread able to follow.
core::BoardTiming timing_of_a_pc() {
  core::BoardTiming timing;
  timing.start_lead_us = 1000;
  timing.late_limit_us = std::numeric_limits<std::uint16_t>::max();
  timing.min_exposure_us = 500;
  timing.min_period_us = 2000;
  return timing;
}

std::int32_t us_of(std::int32_t ticks) { return ticks / (1000 / core::kTick_ns); }

}  // namespace

LineTrigger::LineTrigger(const LineTriggerConfig& config, const CellLines& interlocks)
    : config_(config),
      interlocks_(interlocks),
      wake_fd_(new_wake_event()),
      clock_zero_us_(monotonic_us()),
      sequencer_(0, 0, timing_of_a_pc()) {
  error_ = failure(ResultCode::kLinesLost, "lines: not opened yet").error();
}

LineTrigger::~LineTrigger() {
  stopping_ = true;
  wake();
  if (thread_.joinable()) thread_.join();
  ::close(wake_fd_);
}

Result<void> LineTrigger::open(Gpio& gpio) {
  Result<void> taken = request_wired(gpio, config_.camera, LineUse::kOutput, "camera", camera_);
  if (taken) taken = request_wired(gpio, config_.projector, LineUse::kOutput, "projector", projector_);
  if (taken) taken = request_wired(gpio, config_.strobe, LineUse::kInput, "strobe", strobe_);
  if (taken) taken = request_wired(gpio, config_.busy, LineUse::kOutput, "busy", busy_);
  if (taken) taken = request_wired(gpio, config_.fault, LineUse::kOutput, "fault", fault_);
  if (!taken) return taken;
  const auto level = strobe_->read();
  if (!level) return std::unexpected(level.error());
  const std::uint32_t now_ticks = board_ticks(monotonic_us());
  sequencer_.on_strobe(*level, now_ticks);
  sequencer_.on_inputs(input_bits(interlocks_.inputs()), now_ticks);
  opened_ = true;
  return {};
}

void LineTrigger::start() {
  if (!opened_) return;
  thread_ = std::thread([this] { run(); });
  ::pthread_setname_np(thread_.native_handle(), "trigger");
}

void LineTrigger::wake() const { raise_wake_event(wake_fd_); }

Error LineTrigger::last_error() const {
  if (!interlocks_.inputs().known) return interlocks_.last_error();
  const std::lock_guard lock(mutex_);
  return error_;
}

TriggerInputs LineTrigger::inputs() const {
  const CellInputs inputs = interlocks_.inputs();
  return {connected(), inputs.belt_stopped, inputs.emergency_stop, inputs.changed_us};
}

std::uint8_t LineTrigger::input_bits(const CellInputs& inputs) {
  unsigned bits = 0;
  if (inputs.belt_stopped) bits |= protocol::kInputBeltStopped;
  if (inputs.emergency_stop) bits |= protocol::kInputEmergencyStop;
  return static_cast<std::uint8_t>(bits);
}

std::optional<protocol::Identity> LineTrigger::identity() const {
  const core::BoardTiming timing = timing_of_a_pc();
  protocol::Identity identity;
  identity.tick_ns = core::kTick_ns;
  identity.min_exposure_us = timing.min_exposure_us;
  identity.min_period_us = timing.min_period_us;
  return identity;
}

protocol::StatusReport LineTrigger::status() const {
  const std::lock_guard lock(mutex_);
  return sequencer_.status(board_ticks(monotonic_us()));
}

Result<void> LineTrigger::refresh_status() {
  if (!connected()) return std::unexpected(last_error());
  return {};
}

Result<std::uint16_t> LineTrigger::arm(protocol::Arm sequence) {
  if (!connected()) return std::unexpected(last_error());
  const std::lock_guard lock(mutex_);
  if (next_arm_id_ == 0) next_arm_id_ = 1;  // 0 means "none"
  sequence.arm_id = next_arm_id_++;
  const Result<void> armed = answer(sequencer_.arm(sequence), "ARM");
  drive();
  if (!armed) return std::unexpected(armed.error());
  return sequence.arm_id;
}

Result<void> LineTrigger::start_sequence(std::uint16_t arm_id) {
  if (!connected()) return std::unexpected(last_error());
  Result<void> started;
  {
    const std::lock_guard lock(mutex_);
    worst_late_us_ = 0;
    started = answer(sequencer_.start(arm_id, board_ticks(monotonic_us())), "START");
    drive();
  }
  wake();
  return started;
}

Result<void> LineTrigger::abort() {
  const std::lock_guard lock(mutex_);
  sequencer_.abort();
  drive();
  return {};
}

Result<void> LineTrigger::clear() {
  const std::lock_guard lock(mutex_);
  const Result<void> cleared = answer(sequencer_.clear(), "CLEAR");
  drive();
  return cleared;
}

// With mutex_ held.
Result<void> LineTrigger::answer(Refusal refusal, const char* what) const {
  if (refusal == Refusal::kNone) return {};
  const ResultCode code = refusal == Refusal::kFaultLatched ? code_of(sequencer_.status(0).fault) : code_of(refusal);
  return failure(code, "lines: %s refused: %s", what, protocol::refusal_text(refusal));
}

std::vector<LineShown> LineTrigger::show() const {
  const std::lock_guard lock(mutex_);
  std::vector<LineShown> shown;
  const auto add = [&shown](const char* name, const LineSpec& spec, bool output, bool active) {
    if (spec.wired()) shown.push_back({name, spec, output, active});
  };
  add("camera", config_.camera, true, driven_.camera);
  add("projector", config_.projector, true, driven_.projector);
  add("strobe", config_.strobe, false, strobe_ != nullptr && strobe_->read().value_or(false));
  add("busy", config_.busy, true, driven_.busy);
  add("fault", config_.fault, true, driven_.fault);
  return shown;
}

std::optional<TriggerEvent> LineTrigger::next_event() {
  host_spoke_ = true;
  return events_.pop();
}

std::uint32_t LineTrigger::board_ticks(std::int64_t at_us) const {
  return static_cast<std::uint32_t>((at_us - clock_zero_us_) * 1000 / core::kTick_ns);
}

void LineTrigger::run() {
  make_realtime(RealtimePriority::kTrigger);
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // of an ordinary thread: 50 us otherwise
  while (!stopping_) {
    {
      const std::lock_guard lock(mutex_);
      if (!lost_) take_strobe();
      take_inputs();
      serve_until(board_ticks(monotonic_us()));
      drive();
      hand_on_events();
    }
    wait();
  }
  const std::lock_guard lock(mutex_);
  sequencer_.abort();
  drive();
}

// What follows up to hand_on_events() runs with mutex_ held.
void LineTrigger::take_inputs() {
  const CellInputs inputs = interlocks_.inputs();
  if (!inputs.known) return lose(interlocks_.last_error());
  if (host_spoke_.exchange(false)) sequencer_.host_spoke(board_ticks(monotonic_us()));
  std::uint32_t now_ticks = board_ticks(monotonic_us());
  std::uint32_t due_ticks = 0;
  // Edges that are due are served on their own, with their lateness: an input must not do it by the way.
  if (sequencer_.next_deadline(due_ticks) && static_cast<std::int32_t>(now_ticks - due_ticks) >= 0) {
    now_ticks = due_ticks - 1;
  }
  sequencer_.on_inputs(input_bits(inputs), now_ticks);
}

void LineTrigger::take_strobe() {
  for (;;) {
    const auto edge = strobe_->next_edge();
    if (!edge) return lose(edge.error());
    if (!*edge) return;
    serve_until(board_ticks((*edge)->at_us));
    sequencer_.on_strobe((*edge)->active, board_ticks((*edge)->at_us));
  }
}

void LineTrigger::serve_until(std::uint32_t now_ticks) {
  std::uint32_t due_ticks = 0;
  while (sequencer_.next_deadline(due_ticks) && static_cast<std::int32_t>(now_ticks - due_ticks) >= 0) serve(due_ticks);
}

// One deadline, at its own time; where it is an edge, its lateness is what the clock says once the line is written. A
// late rise sets the board's clock back, so that all that follows moves with it.
void LineTrigger::serve(std::uint32_t at_ticks) {
  const core::Outputs before = sequencer_.outputs();
  sequencer_.on_time(at_ticks);
  drive();
  const core::Outputs now = sequencer_.outputs();
  if (now.camera == before.camera && now.projector == before.projector) return;
  const std::int32_t late_us = us_of(static_cast<std::int32_t>(board_ticks(monotonic_us()) - at_ticks));
  worst_late_us_ = std::max(worst_late_us_.load(), late_us);
  const bool ends_exposure = before.camera && !now.camera;
  if (ends_exposure && late_us > config_.late_limit_us) sequencer_.on_late_edge();
  const bool rises = (now.camera && !before.camera) || (now.projector && !before.projector);
  if (rises) clock_zero_us_ += late_us;
}

// BUSY rises before and falls after the pulses it encloses.
void LineTrigger::drive() {
  const core::Outputs before = driven_;
  const core::Outputs now = sequencer_.outputs();
  driven_ = now;
  if (now.busy) drive_line(busy_.get(), before.busy, now.busy);
  drive_line(projector_.get(), before.projector, now.projector);
  drive_line(camera_.get(), before.camera, now.camera);
  if (!now.busy) drive_line(busy_.get(), before.busy, now.busy);
  drive_line(fault_.get(), before.fault, now.fault);
}

void LineTrigger::drive_line(GpioLine* line, bool before, bool now) {
  if (line == nullptr || before == now) return;
  if (const auto written = line->write(now); !written) lose(written.error());
}

// The outputs that can still be written become safe with the next drive().
void LineTrigger::lose(const Error& error) {
  error_ = error;
  lost_ = true;
  sequencer_.abort();
}

void LineTrigger::hand_on_events() {
  TriggerEvent event;
  event.type = Type::kFrameEvent;
  while (sequencer_.take(event.frame)) push(event);
  event.type = Type::kFaultEvent;
  while (sequencer_.take(event.fault)) push(event);
  event.type = Type::kDoneEvent;
  while (sequencer_.take(event.done)) push(event);
  protocol::InputsEvent inputs;
  while (sequencer_.take(inputs)) {
  }
}

// With the ring full, its reader has gone away: HOST_SILENT follows.
void LineTrigger::push(const TriggerEvent& event) { static_cast<void>(events_.push(event)); }

// Sleeps until shortly before the next deadline, or a strobe, an input or a request; the rest it counts out.
void LineTrigger::wait() {
  std::int64_t left_us = kIdle_us;
  std::int64_t until_us = 0;
  {
    const std::lock_guard lock(mutex_);
    std::uint32_t due_ticks = 0;
    if (sequencer_.next_deadline(due_ticks)) {
      const std::int64_t now_us = monotonic_us();
      until_us = now_us + us_of(static_cast<std::int32_t>(due_ticks - board_ticks(now_us)));
      left_us = std::min(until_us - now_us, kIdle_us);
    }
  }
  const std::int64_t sleep_us = left_us - kSpin_us;
  if (sleep_us > 0) {
    pollfd waits[] = {{wake_fd_, POLLIN, 0}, {interlocks_.changed_fd(), POLLIN, 0}, {strobe_->edge_fd(), POLLIN, 0}};
    const timespec timeout{0, static_cast<long>(sleep_us) * 1000};
    if (::ppoll(waits, lost_ ? 2 : 3, &timeout, nullptr) > 0) {
      clear_wake_event(wake_fd_);
      clear_wake_event(interlocks_.changed_fd());
      return;
    }
  }
  while (monotonic_us() < until_us) {
  }
}

}  // namespace beltpick::capture
