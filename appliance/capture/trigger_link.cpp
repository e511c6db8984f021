#include "capture/trigger_link.hpp"

#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "base/clock.hpp"
#include "base/thread_priority.hpp"
#include "capture/serial_port.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::capture {

using protocol::Fault;
using protocol::Refusal;
using protocol::Type;

namespace {

constexpr int kReopenMs = 250;
constexpr std::int64_t kIdentifyEveryUs = 250'000;
constexpr std::int64_t kIdentifyPatienceUs = 3'000'000;  // a board that resets when it is opened needs two seconds

}  // namespace

TriggerLink::TriggerLink(const TriggerConfig& config) : config_(config) {
  error_ = failure(ResultCode::kTriggerLost, "trigger %s: not opened yet", config_.tty.c_str()).error();
}

TriggerLink::~TriggerLink() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void TriggerLink::start() {
  thread_ = std::thread([this] { run(); });
  ::pthread_setname_np(thread_.native_handle(), "trigger");
}

Error TriggerLink::last_error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

TriggerInputs TriggerLink::inputs() const {
  const std::uint8_t bits = inputs_;
  const bool known = connected_;
  return {known, known && (bits & protocol::kInputBeltStopped) != 0, (bits & protocol::kInputEmergencyStop) != 0,
          inputs_changed_us_};
}

std::optional<protocol::Identity> TriggerLink::identity() const {
  const std::lock_guard lock(mutex_);
  return identity_;
}

protocol::StatusReport TriggerLink::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

// True when it is time to stop.
bool TriggerLink::pause(int milliseconds) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::milliseconds(milliseconds), [this] { return stopping_; });
}

void TriggerLink::run() {
  make_realtime(RealtimePriority::kTrigger);
  while (!pause(0)) {
    if (fd_ < 0 && !open_tty()) {
      if (pause(kReopenMs)) break;
      continue;
    }
    serve_line();
  }
  close_tty(lost("closed"));
}

bool TriggerLink::open_tty() {
  const Result<int> opened = open_serial(config_.tty.c_str());
  const std::lock_guard lock(mutex_);
  if (!opened) {
    error_ = opened.error();
    tried_ = true;
    return false;
  }
  fd_ = *opened;
  decoder_ = protocol::FrameDecoder();
  heard_us_ = monotonic_us();
  polled_us_ = 0;
  damaged_when_heard_ = damaged_;
  identified_ = false;
  other_version_.reset();
  next_event_sequence_.reset();
  return true;
}

void TriggerLink::close_tty(const Error& why) {
  const std::lock_guard lock(mutex_);
  connected_ = false;
  tried_ = true;
  inputs_ = 0;
  inputs_changed_us_ = monotonic_us();
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  error_ = why;
  changed_.notify_all();
}

Error TriggerLink::lost(const char* why) const {
  return failure(ResultCode::kTriggerLost, "trigger %s: %s; check its cable and power", config_.tty.c_str(), why)
      .error();
}

// Why nothing good comes from the firmware any more.
Error TriggerLink::silent() const {
  if (other_version_) {
    return failure(ResultCode::kTriggerLost,
                   "trigger %s: expected protocol version %u, found %u; flash the matching firmware",
                   config_.tty.c_str(), unsigned{protocol::kVersion}, unsigned{*other_version_})
        .error();
  }
  if (!noisy_since(damaged_when_heard_))
    return lost("the firmware does not answer ('beltpick flash' gives a board its firmware)");
  return failure(ResultCode::kTriggerLineNoisy,
                 "trigger %s: nothing comes whole any more, %u damaged messages; check its cable, shield and ground",
                 config_.tty.c_str(), damaged_ - damaged_when_heard_)
      .error();
}

// What never was the firmware may be another device altogether.
bool TriggerLink::noisy_since(unsigned damaged_before) const { return known_ && damaged_ != damaged_before; }

// One turn of the link thread: at most a few milliseconds of waiting, so that polls and losses are punctual.
void TriggerLink::serve_line() {
  pollfd line{fd_, POLLIN, 0};
  ::poll(&line, 1, 10);
  if ((line.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
    close_tty(lost("the line hung up"));
    return;
  }
  if ((line.revents & POLLIN) != 0) read_bytes();
  const std::int64_t silent_us = monotonic_us() - heard_us_;
  if (silent_us > (connected_ ? config_.lost_ms * std::int64_t{1000} : kIdentifyPatienceUs)) {
    close_tty(silent());
    return;
  }
  poll_firmware();
}

void TriggerLink::read_bytes() {
  std::uint8_t bytes[256];
  const ssize_t count = ::read(fd_, bytes, sizeof bytes);
  for (ssize_t i = 0; i < count; ++i) {
    const protocol::FrameDecoder::Outcome outcome = decoder_.push(bytes[i]);
    if (outcome == protocol::FrameDecoder::Outcome::kMessage) take_message();
    if (outcome == protocol::FrameDecoder::Outcome::kDamaged) ++damaged_;
  }
}

void TriggerLink::poll_firmware() {
  const std::int64_t now_us = monotonic_us();
  if (now_us - polled_us_ < (identified_ ? config_.poll_ms * std::int64_t{1000} : kIdentifyEveryUs)) return;
  polled_us_ = now_us;
  std::uint8_t frame[protocol::kMaxOutgoingFrame];
  const Type type = identified_ ? Type::kStatus : Type::kIdentify;
  const std::size_t size = protocol::encode(type, ++sequence_, protocol::Empty(), frame, sizeof frame);
  const std::lock_guard lock(mutex_);
  write_frame(frame, size);
}

bool TriggerLink::write_frame(const std::uint8_t* frame, std::size_t size) {
  // A zero before it: a frame whose end the line lost does not take this one along.
  std::uint8_t bytes[1 + protocol::kMaxFrame] = {};
  std::copy_n(frame, size, bytes + 1);
  return fd_ >= 0 && ::write(fd_, bytes, size + 1) == static_cast<ssize_t>(size + 1);
}

void TriggerLink::take_message() {
  protocol::Header header;
  if (!protocol::decode_header(decoder_.message(), decoder_.size(), header)) return;
  if (header.version != protocol::kVersion) {
    other_version_ = header.version;
    return;
  }
  heard_us_ = monotonic_us();
  damaged_when_heard_ = damaged_;
  if (header.type == Type::kReply) {
    take_reply(header);
  } else if (header.type == Type::kIdentity) {
    take_identity();
  } else if (header.type == Type::kStatusReport) {
    take_status(header);
  } else {
    take_event(header);
  }
}

void TriggerLink::take_reply(const protocol::Header& header) {
  protocol::Reply reply;
  if (!protocol::decode_payload(decoder_.message(), decoder_.size(), reply)) return;
  const std::lock_guard lock(mutex_);
  settle_request(header.sequence, reply.refusal);
}

// With mutex_ held.
void TriggerLink::settle_request(std::uint8_t sequence, Refusal refusal) {
  if (!pending_.waiting || sequence != pending_.sequence) return;
  pending_.refusal = refusal;
  changed_.notify_all();
}

void TriggerLink::take_identity() {
  protocol::Identity identity;
  if (!protocol::decode_payload(decoder_.message(), decoder_.size(), identity)) return;
  identified_ = true;
  known_ = true;
  polled_us_ = 0;
  const std::lock_guard lock(mutex_);
  identity_ = identity;
}

void TriggerLink::take_status(const protocol::Header& header) {
  protocol::StatusReport report;
  if (!protocol::decode_payload(decoder_.message(), decoder_.size(), report)) return;
  {
    const std::lock_guard lock(mutex_);
    status_ = report;
    if (!connected_) next_arm_id_ = static_cast<std::uint16_t>(report.arm_id + 1);
    settle_request(header.sequence, Refusal::kNone);
  }
  take_inputs(report.inputs);
  connected_ = true;
  tried_ = true;
}

// Known at once, not only with the next poll.
void TriggerLink::take_fault(const protocol::FaultEvent& fault) {
  const std::lock_guard lock(mutex_);
  status_.state = protocol::State::kFault;
  status_.fault = fault.fault;
  status_.fault_frame = fault.frame;
  status_.arm_id = fault.arm_id;
}

void TriggerLink::take_inputs(std::uint8_t inputs) {
  if (inputs_ == inputs) return;
  inputs_changed_us_ = monotonic_us();
  inputs_ = inputs;
}

void TriggerLink::take_event(const protocol::Header& header) {
  if (next_event_sequence_ && *next_event_sequence_ != header.sequence) {
    events_lost_ += static_cast<std::uint8_t>(header.sequence - *next_event_sequence_);
  }
  next_event_sequence_ = static_cast<std::uint8_t>(header.sequence + 1);
  const std::uint8_t* message = decoder_.message();
  const std::size_t size = decoder_.size();
  TriggerEvent event;
  event.type = header.type;
  bool whole = false;
  if (header.type == Type::kInputsEvent) {
    protocol::InputsEvent inputs;
    if (protocol::decode_payload(message, size, inputs)) take_inputs(inputs.inputs);
    return;
  }
  if (header.type == Type::kFrameEvent) whole = protocol::decode_payload(message, size, event.frame);
  if (header.type == Type::kDoneEvent) whole = protocol::decode_payload(message, size, event.done);
  if (header.type == Type::kFaultEvent) {
    whole = protocol::decode_payload(message, size, event.fault);
    if (whole) take_fault(event.fault);
  }
  if (whole && !events_.push(event)) ++events_lost_;
}

template <class Payload>
Result<void> TriggerLink::request(Type type, const Payload& payload, const char* what) {
  std::uint8_t frame[protocol::kMaxFrame];
  const std::uint8_t sequence = ++sequence_;
  const std::size_t size = protocol::encode(type, sequence, payload, frame, sizeof frame);
  const Result<Refusal> refusal = exchange(frame, size, sequence, what);
  if (!refusal) return std::unexpected(refusal.error());
  if (*refusal == Refusal::kNone) return {};
  const ResultCode code = *refusal == Refusal::kFaultLatched ? code_of(status().fault) : code_of(*refusal);
  return failure(code, "trigger %s: %s refused: %s", config_.tty.c_str(), what, protocol::refusal_text(*refusal));
}

// Sends until the reply with this sequence number is there; the firmware takes a repetition as the same request.
Result<Refusal> TriggerLink::exchange(const std::uint8_t* frame, std::size_t size, std::uint8_t sequence,
                                      const char* what) {
  std::unique_lock lock(mutex_);
  const unsigned damaged_before = damaged_;
  pending_ = {true, sequence, std::nullopt};
  for (int attempt = 0; attempt < config_.tries && connected_ && !pending_.refusal; ++attempt) {
    write_frame(frame, size);
    changed_.wait_for(lock, std::chrono::milliseconds(config_.reply_ms),
                      [this] { return pending_.refusal.has_value() || !connected_ || stopping_; });
  }
  pending_.waiting = false;
  if (pending_.refusal) return *pending_.refusal;
  if (!connected_) return std::unexpected(error_);
  if (noisy_since(damaged_before)) {
    return failure(ResultCode::kTriggerLineNoisy,
                   "trigger %s: no reply to %s in %d tries, and damaged messages; check its cable, shield and ground",
                   config_.tty.c_str(), what, config_.tries);
  }
  return failure(ResultCode::kTriggerLost, "trigger %s: no reply to %s in %d tries; check its cable and power",
                 config_.tty.c_str(), what, config_.tries);
}

Result<std::uint16_t> TriggerLink::arm(protocol::Arm sequence) {
  {
    const std::lock_guard lock(mutex_);
    if (next_arm_id_ == 0) next_arm_id_ = 1;  // 0 means "none"
    sequence.arm_id = next_arm_id_++;
  }
  const Result<void> done = request(Type::kArm, sequence, "ARM");
  if (!done) return std::unexpected(done.error());
  return sequence.arm_id;
}

Result<void> TriggerLink::start_sequence(std::uint16_t arm_id) {
  return request(Type::kStart, protocol::Start{arm_id}, "START");
}

Result<void> TriggerLink::refresh_status() { return request(Type::kStatus, protocol::Empty(), "STATUS"); }

Result<void> TriggerLink::abort() { return request(Type::kAbort, protocol::Empty(), "ABORT"); }

Result<void> TriggerLink::clear() { return request(Type::kClear, protocol::Empty(), "CLEAR"); }

}  // namespace beltpick::capture
