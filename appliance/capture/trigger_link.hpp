// TriggerLink: the appliance's end of the trigger protocol (trigger_fw/protocol/PROTOCOL.md). A thread of its own opens
// the tty, identifies the firmware, polls its status, and opens it anew after a loss. Allocates nothing after start().
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
#include "capture/trigger_source.hpp"
#include "protocol/messages.hpp"

namespace beltpick::capture {

struct TriggerConfig {
  std::string tty;    // e.g. /dev/ttyACM0
  int poll_ms = 50;   // between two STATUS requests; they also tell the firmware that we live
  int reply_ms = 40;  // for a reply, per try: what noise damaged is repeated before 100 ms are over
  int tries = 10;
  int lost_ms = 500;  // without a good message the firmware is lost
};

class TriggerLink : public TriggerSource {
 public:
  explicit TriggerLink(const TriggerConfig& config);
  ~TriggerLink() override;
  TriggerLink(const TriggerLink&) = delete;
  TriggerLink& operator=(const TriggerLink&) = delete;

  void start() override;
  // Connected: the firmware is identified and answers.
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] Error last_error() const override;
  [[nodiscard]] bool tried() const override { return tried_; }
  [[nodiscard]] TriggerInputs inputs() const override;
  [[nodiscard]] std::optional<protocol::Identity> identity() const override;
  // At most poll_ms old while connected.
  [[nodiscard]] protocol::StatusReport status() const override;
  Result<void> refresh_status() override;
  Result<std::uint16_t> arm(protocol::Arm sequence) override;
  Result<void> start_sequence(std::uint16_t arm_id) override;
  Result<void> abort() override;
  Result<void> clear() override;
  std::optional<TriggerEvent> next_event() override { return events_.pop(); }
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
  void close_tty(const Error& why);
  [[nodiscard]] Error lost(const char* why) const;
  [[nodiscard]] Error silent() const;
  [[nodiscard]] bool noisy_since(unsigned damaged_before) const;
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
  std::atomic<unsigned> damaged_{0};  // frames that came, but not whole
  std::atomic<bool> known_{false};    // the firmware was identified once
  std::atomic<std::uint8_t> sequence_{0};
  Ring<TriggerEvent, 256> events_;

  // The link thread's own.
  protocol::FrameDecoder decoder_;
  std::int64_t heard_us_ = 0;
  std::int64_t polled_us_ = 0;
  unsigned damaged_when_heard_ = 0;
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
