// TriggerLink: the appliance's end of the trigger protocol (trigger_fw/protocol/PROTOCOL.md). A thread of its own opens
// the tty, identifies the firmware, polls its status, and opens it anew after a loss. Allocates nothing after start().
//
// Requests block their caller until the reply (some 100 ms at worst per try) and may come from any one thread at a
// time.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/result.hpp"
#include "base/ring.hpp"
#include "protocol/messages.hpp"

namespace beltpick::capture {

struct TriggerConfig {
  std::string tty;     // e.g. /dev/ttyACM0
  int poll_ms = 50;    // between two STATUS requests; they also tell the firmware that we live
  int reply_ms = 100;  // for a reply, per try
  int tries = 4;
  int lost_ms = 500;  // without a good message the firmware is lost
};

// The interlock inputs of the microcontroller. Not known means not safe: belt_stopped is false then.
struct TriggerInputs {
  bool known = false;
  bool belt_stopped = false;
  bool emergency_stop = false;
  std::int64_t changed_us = 0;  // monotonic_us() when we heard of the last change
};

struct TriggerEvent {
  protocol::Type type = protocol::Type::kFrameEvent;  // kFrameEvent, kDoneEvent or kFaultEvent
  protocol::FrameEvent frame;
  protocol::DoneEvent done;
  protocol::FaultEvent fault;
};

// The appliance's code for a firmware fault: 200 + n, except for what the register table names itself (belt moved,
// emergency stop).
ResultCode code_of(protocol::Fault fault);

class TriggerLink {
 public:
  explicit TriggerLink(const TriggerConfig& config);
  ~TriggerLink();
  TriggerLink(const TriggerLink&) = delete;
  TriggerLink& operator=(const TriggerLink&) = delete;

  // Starts the thread; returns at once.
  void start();

  // True while the firmware is identified and answers.
  [[nodiscard]] bool connected() const { return connected_; }
  // Why it is not: kTriggerLost with the reason.
  [[nodiscard]] Error last_error() const;
  [[nodiscard]] TriggerInputs inputs() const;
  // True once it is known whether the firmware answers.
  [[nodiscard]] bool tried() const { return tried_; }
  // The firmware found last; nothing before.
  [[nodiscard]] std::optional<protocol::Identity> identity() const;
  // The latest STATUS of the firmware; at most poll_ms old while connected.
  [[nodiscard]] protocol::StatusReport status() const;

  // Asks for a STATUS and waits for it: status() is then of now.
  Result<void> refresh_status();
  // Arms the sequence under a new id, which is returned. kValueOutOfRange when the firmware says it cannot be run.
  Result<std::uint16_t> arm(protocol::Arm sequence);
  // kBeltMovedDuringCapture or kEmergencyStop when the interlocks forbid it.
  Result<void> start_sequence(std::uint16_t arm_id);
  Result<void> abort();
  // Ends a latched firmware fault. kEmergencyStop while that is pressed.
  Result<void> clear();

  // The events of the running sequence, in order; for one consumer. Those of an older arm id are the caller's to skip.
  std::optional<TriggerEvent> next_event() { return events_.pop(); }
  // Events that the wire or a full ring lost since start().
  [[nodiscard]] unsigned events_lost() const { return events_lost_; }

 private:
  struct Pending {
    bool waiting = false;
    std::uint8_t sequence = 0;
    std::optional<protocol::Refusal> refusal;
  };

  void run();
  bool open_tty();
  void close_tty(const char* why);
  void close_silent();
  void serve_line();
  void read_bytes();
  void poll_firmware();
  void take_message();
  void take_reply(const protocol::Header& header);
  void settle_request(std::uint8_t sequence, protocol::Refusal refusal);
  void take_event(const protocol::Header& header);
  void take_identity();
  void take_status(const protocol::Header& header);
  void take_fault(const protocol::FaultEvent& fault);
  void take_inputs(std::uint8_t inputs);
  bool write_frame(const std::uint8_t* frame, std::size_t size);
  template <class Payload>
  Result<void> request(protocol::Type type, const Payload& payload, const char* what);
  Result<protocol::Refusal> exchange(const std::uint8_t* frame, std::size_t size, std::uint8_t sequence,
                                     const char* what);
  bool pause(int milliseconds);

  TriggerConfig config_;
  std::atomic<bool> connected_{false};
  std::atomic<bool> tried_{false};
  std::atomic<std::uint8_t> inputs_{0};
  std::atomic<std::int64_t> inputs_changed_us_{0};
  std::atomic<unsigned> events_lost_{0};
  std::atomic<std::uint8_t> sequence_{0};
  Ring<TriggerEvent, 256> events_;

  // The link thread's own.
  protocol::FrameDecoder decoder_;
  std::int64_t heard_us_ = 0;
  std::int64_t polled_us_ = 0;
  bool identified_ = false;
  std::optional<std::uint8_t> other_version_;  // of the protocol, as the firmware speaks it
  std::optional<std::uint8_t> next_event_sequence_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  int fd_ = -1;
  Pending pending_;
  protocol::StatusReport status_;
  std::optional<protocol::Identity> identity_;
  std::uint16_t next_arm_id_ = 0;
  Error error_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace beltpick::capture
