#include "host/board.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <system_error>

namespace beltpick::host {

namespace {

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::uint8_t input_bits(const BoardOptions& options) {
  return static_cast<std::uint8_t>((options.belt_stopped ? protocol::kInputBeltStopped : 0) |
                                   (options.emergency_stop ? protocol::kInputEmergencyStop : 0));
}

constexpr std::chrono::milliseconds kWatchdog(256);  // as on the microcontrollers

protocol::Identity identity(std::uint8_t reset_cause = protocol::kResetPowerOn) {
  protocol::Identity identity;
  identity.board = protocol::BoardKind::kHost;
  identity.firmware_minor = 2;
  identity.reset_cause = reset_cause;
  return identity;
}

}  // namespace

Board::Board(BoardOptions options)
    : options_(std::move(options)),
      terminal_(options_.link),
      wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      clock_zero_ns_(now_ns()),
      inputs_(input_bits(options_)),
      device_(identity(), inputs_, 0) {
  if (wake_fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  thread_ = std::thread([this] { run(); });
}

Board::~Board() {
  stopping_ = true;
  wake();
  thread_.join();
  ::close(wake_fd_);
}

void Board::wake() {
  const std::uint64_t one = 1;
  // A full counter wakes as well.
  [[maybe_unused]] const ssize_t written = ::write(wake_fd_, &one, sizeof one);
}

std::int64_t Board::raw_ticks() const { return (now_ns() - clock_zero_ns_) / core::kTick_ns; }

// The core's clock has 32 bits of it.
std::uint32_t Board::core_ticks(std::int64_t ticks) { return static_cast<std::uint32_t>(ticks); }

// How much of the time up to `ticks` lies behind the core's next deadline; below 0 while it is ahead.
std::optional<std::int32_t> Board::late_by(std::int64_t ticks) const {
  std::uint32_t deadline_ticks = 0;
  if (!device_.sequencer().next_deadline(deadline_ticks)) return std::nullopt;
  return static_cast<std::int32_t>(core_ticks(ticks) - deadline_ticks);
}

// The clock does not pass a deadline that the thread has not served yet.
std::int64_t Board::board_ticks() const {
  const std::int64_t now = raw_ticks();
  const auto late_ticks = late_by(now);
  return late_ticks && *late_ticks >= 0 ? now - *late_ticks - 1 : now;
}

void Board::set_strobe(bool active) {
  {
    const std::lock_guard lock(mutex_);
    if (swallowed({strobes_to_drop_, strobe_cut_}, active)) return;
    device_.sequencer().on_strobe(active, core_ticks(board_ticks()));
  }
  wake();
}

void Board::set_belt_stopped(bool stopped) { set_input(protocol::kInputBeltStopped, stopped); }

void Board::set_emergency_stop(bool pressed) { set_input(protocol::kInputEmergencyStop, pressed); }

void Board::set_input(std::uint8_t bit, bool level) {
  {
    const std::lock_guard lock(mutex_);
    inputs_ = static_cast<std::uint8_t>(level ? inputs_ | bit : inputs_ & ~bit);
    device_.sequencer().on_inputs(inputs_, core_ticks(board_ticks()));
  }
  wake();
}

// A pulse is swallowed whole: its fall follows its rise.
bool Board::swallowed(WireFault fault, bool level) {
  if (level && fault.left > 0) {
    --fault.left;
    fault.cut = true;
    return true;
  }
  const bool cut = fault.cut;
  fault.cut = false;
  return cut && !level;
}

protocol::StatusReport Board::status() {
  const std::lock_guard lock(mutex_);
  return device_.sequencer().status(core_ticks(board_ticks()));
}

// What a request or an input changed is published before a deadline is served: no edge may hide behind the next one.
void Board::run() {
  while (!stopping_) {
    if (hang_wanted_.exchange(false)) hang_and_restart();
    receive();
    publish(false);
    publish(true);
    transmit();
    wait();
  }
}

// The outputs stay as they are meanwhile, as those of a microcontroller do.
void Board::hang_and_restart() {
  std::this_thread::sleep_for(kWatchdog);
  const std::lock_guard lock(mutex_);
  device_ = core::Device(identity(protocol::kResetWatchdog), inputs_, core_ticks(raw_ticks()));
}

// Hands the edges of the output pins to the callback, without the lock; first serves what is due, if so asked.
void Board::publish(bool serving) {
  core::Outputs out;
  std::int64_t at_ticks = 0;
  {
    const std::lock_guard lock(mutex_);
    at_ticks = serving ? serve() : board_ticks();
    out = device_.sequencer().outputs();
  }
  emit_changes(out, static_cast<std::uint32_t>(at_ticks * core::kTick_ns / 1000));
}

// Serves the deadline that is due, if one is, at its own time: the clock is set back by the delay. Returns that time.
std::int64_t Board::serve() {
  const std::int64_t now = raw_ticks();
  const auto late_ticks = late_by(now);
  if (!late_ticks || *late_ticks < 0) return now;
  clock_zero_ns_ += std::int64_t{*late_ticks} * core::kTick_ns;
  device_.sequencer().on_time(core_ticks(now - *late_ticks));
  return now - *late_ticks;
}

// BUSY rises before and falls after the pulses it encloses: its rise sets the projector back.
void Board::emit_changes(const core::Outputs& out, std::uint32_t board_us) {
  const core::Outputs before = published_;
  published_ = out;
  if (out.busy && !before.busy) emit(Pin::kBusy, true, board_us);
  if (out.projector != before.projector && !swallowed({advances_to_drop_, advance_cut_}, out.projector)) {
    emit(Pin::kProjectorAdvance, out.projector, board_us);
  }
  if (out.camera != before.camera && !swallowed({pulses_to_drop_, pulse_cut_}, out.camera)) {
    emit(Pin::kCameraTrigger, out.camera, board_us);
  }
  if (!out.busy && before.busy) emit(Pin::kBusy, false, board_us);
  if (out.done != before.done) emit(Pin::kDone, out.done, board_us);
  if (out.fault != before.fault) emit(Pin::kFault, out.fault, board_us);
}

void Board::emit(Pin pin, bool level, std::uint32_t board_us) {
  if (options_.on_edge) options_.on_edge({pin, level, board_us, now_ns()});
}

void Board::receive() {
  std::uint8_t bytes[256];
  noise_.set_share(noise_share_);
  const std::size_t count = noise_.pass(bytes, terminal_.read(bytes, sizeof bytes));
  if (count == 0 || muted_) return;
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < count; ++i) device_.on_byte(bytes[i], core_ticks(board_ticks()));
}

void Board::transmit() {
  std::uint8_t bytes[256];
  std::size_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    while (count < sizeof bytes && device_.next_byte(bytes[count])) ++count;
  }
  count = noise_.pass(bytes, count);
  if (!muted_) terminal_.write(bytes, count);
}

// Sleeps until the next deadline, a byte on the line or a change of an input.
void Board::wait() {
  timespec timeout{.tv_sec = 0, .tv_nsec = 100'000'000};
  {
    const std::lock_guard lock(mutex_);
    if (const auto late_ticks = late_by(raw_ticks())) {
      if (*late_ticks >= 0) return;
      timeout.tv_nsec = std::min(timeout.tv_nsec, -*late_ticks * std::int64_t{core::kTick_ns});
    }
  }
  pollfd waits[] = {{terminal_.fd(), POLLIN, 0}, {wake_fd_, POLLIN, 0}};
  ::ppoll(waits, 2, &timeout, nullptr);
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t size = ::read(wake_fd_, &count, sizeof count);
}

}  // namespace beltpick::host
