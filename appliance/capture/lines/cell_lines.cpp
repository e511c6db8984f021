#include "capture/lines/cell_lines.hpp"

#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "base/clock.hpp"
#include "base/thread_priority.hpp"
#include "capture/lines/wake_event.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {

constexpr std::int64_t kLookAgain_us = 100'000;  // at the levels themselves: an edge may have been lost
constexpr auto kStartPulse = std::chrono::milliseconds(1);

}  // namespace

CellLines::CellLines(const CellLinesConfig& config)
    : config_(config),
      inputs_{{{"belt_stopped", &config_.belt_stopped, false, true, nullptr, {}},
               {"emergency_stop", &config_.emergency_stop, true, true, nullptr, {}},
               {"busy", &config_.busy, false, false, nullptr, {}},
               {"fault", &config_.fault, true, false, nullptr, {}}}},
      changed_fd_(new_wake_event()),
      stop_fd_(new_wake_event()) {
  active_ = 1U << kBeltStopped;  // what is not wired is harmless
}

CellLines::~CellLines() {
  raise_wake_event(stop_fd_);
  if (thread_.joinable()) thread_.join();
  permit_belt(false);
  ::close(changed_fd_);
  ::close(stop_fd_);
}

Result<void> CellLines::open(Gpio& gpio) {
  for (Watched& input : inputs_) {
    if (const auto taken = request_wired(gpio, *input.spec, LineUse::kInput, input.name, input.line); !taken)
      return taken;
    if (input.line == nullptr) continue;
    const auto level = input.line->read();
    if (!level) return std::unexpected(level.error());
    const std::int64_t hold_us = input.debounced ? config_.debounce_ms * std::int64_t{1000} : 0;
    input.level = Debounce(input.safe_level, hold_us, *level);
  }
  if (const auto taken = request_wired(gpio, config_.start, LineUse::kOutput, "start", start_); !taken) return taken;
  const auto taken = request_wired(gpio, config_.belt_may_move, LineUse::kOutput, "belt_may_move", permission_);
  if (!taken) return taken;
  publish();
  return {};
}

void CellLines::start() {
  if (std::ranges::none_of(inputs_, [](const Watched& input) { return input.line != nullptr; })) return;
  thread_ = std::thread([this] { run(); });
  ::pthread_setname_np(thread_.native_handle(), "lines");
}

CellInputs CellLines::inputs() const {
  if (lost_) return {};
  const unsigned active = active_;
  const auto is = [active](Input input) { return (active & (1U << input)) != 0; };
  return {true, is(kBeltStopped), is(kEmergencyStop), is(kBusy), is(kFault), busy_rises_, changed_us_};
}

Error CellLines::last_error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

void CellLines::run() {
  make_realtime(RealtimePriority::kTrigger);
  while (!lost_) {
    wait();
    pollfd stop{stop_fd_, POLLIN, 0};
    if (::poll(&stop, 1, 0) > 0) return;
    if (const auto taken = take_edges(); !taken) lose(taken.error());
    publish();
  }
}

// Until an edge comes, a debounce time ends, or it is time to look again.
void CellLines::wait() {
  pollfd waits[kInputCount + 1] = {{stop_fd_, POLLIN, 0}};
  nfds_t count = 1;
  const std::int64_t now_us = monotonic_us();
  std::int64_t until_us = now_us + kLookAgain_us;
  for (const Watched& input : inputs_) {
    if (input.line == nullptr) continue;
    waits[count++] = {input.line->edge_fd(), POLLIN, 0};
    if (const auto due_us = input.level.due_us()) until_us = std::min(until_us, *due_us);
  }
  const std::int64_t left_us = std::max<std::int64_t>(until_us - now_us, 0);
  const timespec timeout{0, static_cast<long>(left_us) * 1000};
  if (::ppoll(waits, count, &timeout, nullptr) == 0) look_again();
}

Result<void> CellLines::take_edges() {
  for (Watched& input : inputs_) {
    while (input.line != nullptr) {
      const auto edge = input.line->next_edge();
      if (!edge) return std::unexpected(edge.error());
      if (!*edge) break;
      if (&input == &inputs_[kBusy] && (*edge)->active) ++busy_rises_;
      const bool before = input.level.active();
      input.level.edge((*edge)->active, (*edge)->at_us);
      if (input.debounced && input.level.active() != before) changed_us_ = (*edge)->at_us;
    }
    input.level.advance(monotonic_us());
  }
  return {};
}

void CellLines::look_again() {
  for (Watched& input : inputs_) {
    if (input.line == nullptr) continue;
    const auto level = input.line->read();
    if (!level) return lose(level.error());
    input.level.edge(*level, monotonic_us());
  }
}

void CellLines::publish() {
  unsigned active = 0;
  for (std::size_t i = 0; i < kInputCount; ++i) {
    const bool level = inputs_[i].line != nullptr ? inputs_[i].level.active() : i == kBeltStopped;
    active |= level ? 1U << i : 0U;
  }
  const unsigned before = active_.exchange(static_cast<std::uint8_t>(active));
  drive_permission();
  constexpr unsigned kInterlocks = (1U << kBeltStopped) | (1U << kEmergencyStop);
  if (((before ^ active) & kInterlocks) != 0) raise_wake_event(changed_fd_);
}

void CellLines::permit_belt(bool may_move) {
  {
    const std::lock_guard lock(mutex_);
    permitted_ = may_move;
  }
  drive_permission();
}

void CellLines::drive_permission() {
  // Looked at under the lock: of two threads the one that writes last must not have looked first.
  const std::lock_guard lock(mutex_);
  const CellInputs inputs = this->inputs();
  const bool wanted = permitted_ && inputs.known && !inputs.emergency_stop && !inputs.fault;
  if (permission_ == nullptr || wanted == driven_) return;
  driven_ = wanted;
  if (const auto written = permission_->write(wanted); !written) {
    error_ = written.error();
    lost_ = true;
  }
}

void CellLines::lose(const Error& error) {
  {
    const std::lock_guard lock(mutex_);
    error_ = error;
  }
  lost_ = true;
  raise_wake_event(changed_fd_);
}

Result<void> CellLines::pulse_start() {
  if (const auto risen = start_->write(true); !risen) return risen;
  std::this_thread::sleep_for(kStartPulse);
  return start_->write(false);
}

std::vector<LineShown> CellLines::show() const {
  const CellInputs now = inputs();
  std::vector<LineShown> shown;
  const auto add = [&shown](const char* name, const LineSpec& spec, bool output, bool active) {
    if (spec.wired()) shown.push_back({name, spec, output, active});
  };
  add("belt_stopped", config_.belt_stopped, false, now.belt_stopped);
  add("emergency_stop", config_.emergency_stop, false, now.emergency_stop);
  add("busy", config_.busy, false, now.busy);
  add("fault", config_.fault, false, now.fault);
  const std::lock_guard lock(mutex_);
  add("belt_may_move", config_.belt_may_move, true, driven_);
  add("start", config_.start, true, false);
  return shown;
}

}  // namespace beltpick::capture
