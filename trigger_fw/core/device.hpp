// Device: the firmware as its serial line sees it: bytes in, requests to the sequencer, replies and events out.
#pragma once

#include "core/sequencer.hpp"
#include "protocol/messages.hpp"

namespace beltpick {
namespace core {

class Device {
 public:
  // `identity`: what the board knows of itself; its limits come from `board`. `inputs`: protocol::InputBit as the pins
  // read at start. Why the board started, or what its flash holds, may be a fault from the start.
  Device(const protocol::Identity& identity, uint8_t inputs, uint32_t now_ticks,
         const BoardTiming& board = BoardTiming());

  Sequencer& sequencer() { return sequencer_; }
  const Sequencer& sequencer() const { return sequencer_; }

  void on_byte(uint8_t byte, uint32_t now_ticks);

  // The next byte for the wire; false when there is none. An event leaves the sequencer as soon as there is room for
  // it.
  bool next_byte(uint8_t& byte);

  // The host wants the boot loader, and has been told yes: time to go there.
  bool loader_due() const { return loader_wanted_ && queue_count_ == 0 && !sequencer_.running(); }

 private:
  static constexpr uint8_t kQueueBytes = 128;                               // a power of two: no division
  static constexpr uint8_t kRoomOfFrame = protocol::kMaxOutgoingFrame + 1;  // and the zero before it

  void serve(uint32_t now_ticks);
  void serve_arm(const protocol::Header& header);
  void serve_start(const protocol::Header& header, uint32_t now_ticks);
  void serve_simple(const protocol::Header& header, uint32_t now_ticks);
  protocol::Refusal ask_for_loader();
  void reply(const protocol::Header& header, protocol::Refusal refusal);
  void send_event();
  template <class Payload>
  void answer(protocol::Type type, uint8_t sequence, const Payload& payload);
  uint8_t room() const { return static_cast<uint8_t>(kQueueBytes - queue_count_); }
  void queue(uint8_t byte);
  template <class Payload>
  void send(protocol::Type type, uint8_t sequence, const Payload& payload);
  template <class Event>
  bool send_pending(protocol::Type type);

  protocol::Identity identity_;
  Sequencer sequencer_;
  protocol::FrameDecoder decoder_;
  uint8_t event_sequence_ = 0;
  bool loader_wanted_ = false;
  uint8_t queue_[kQueueBytes] = {};
  uint8_t queue_head_ = 0;
  uint8_t queue_count_ = 0;
};

}  // namespace core
}  // namespace beltpick
