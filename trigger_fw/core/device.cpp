#include "core/device.hpp"

namespace beltpick {
namespace core {

using protocol::Fault;
using protocol::Header;
using protocol::Refusal;
using protocol::Type;

namespace {

// At power-up the supply rises through the brown-out's threshold: that is none.
Fault fault_at_start(const protocol::Identity& identity) {
  if (identity.flash_state == protocol::FlashState::kDamaged) return Fault::kFlashDamaged;
  if ((identity.reset_cause & protocol::kResetWatchdog) != 0) return Fault::kWatchdogReset;
  const bool powered_on = (identity.reset_cause & protocol::kResetPowerOn) != 0;
  if ((identity.reset_cause & protocol::kResetBrownOut) != 0 && !powered_on) return Fault::kBrownOut;
  return Fault::kNone;
}

}  // namespace

Device::Device(const protocol::Identity& identity, uint8_t inputs, uint32_t now_ticks, const BoardTiming& board)
    : identity_(identity), sequencer_(inputs, now_ticks, board, fault_at_start(identity)) {
  identity_.tick_ns = kTick_ns;
  identity_.min_exposure_us = board.min_exposure_us;
  identity_.min_period_us = board.min_period_us;
  identity_.min_interval_us = board.min_interval_us;
}

void Device::on_byte(uint8_t byte, uint32_t now_ticks) {
  if (decoder_.push(byte) == protocol::FrameDecoder::Outcome::kMessage) serve(now_ticks);
}

void Device::serve(uint32_t now_ticks) {
  Header header;
  if (!protocol::decode_header(decoder_.message(), decoder_.size(), header)) return;
  if (header.version != protocol::kVersion) {
    reply(header, Refusal::kWrongVersion);
    return;
  }
  sequencer_.host_spoke(now_ticks);
  if (header.type == Type::kArm) {
    serve_arm(header);
  } else if (header.type == Type::kStart) {
    serve_start(header, now_ticks);
  } else if (decoder_.size() != protocol::kHeaderBytes) {
    reply(header, Refusal::kMalformed);
  } else {
    serve_simple(header, now_ticks);
  }
}

void Device::serve_arm(const Header& header) {
  protocol::Arm arm;
  const bool whole = protocol::decode_payload(decoder_.message(), decoder_.size(), arm);
  reply(header, whole ? sequencer_.arm(arm) : Refusal::kMalformed);
}

void Device::serve_start(const Header& header, uint32_t now_ticks) {
  protocol::Start start;
  const bool whole = protocol::decode_payload(decoder_.message(), decoder_.size(), start);
  reply(header, whole ? sequencer_.start(start.arm_id, now_ticks) : Refusal::kMalformed);
}

void Device::serve_simple(const Header& header, uint32_t now_ticks) {
  switch (header.type) {
    case Type::kIdentify:
      answer(Type::kIdentity, header.sequence, identity_);
      return;
    case Type::kStatus:
      answer(Type::kStatusReport, header.sequence, sequencer_.status(now_ticks));
      return;
    case Type::kAbort:
      sequencer_.abort();
      reply(header, Refusal::kNone);
      return;
    case Type::kClear:
      reply(header, sequencer_.clear());
      return;
    case Type::kKeepalive:
      reply(header, Refusal::kNone);
      return;
    case Type::kEnterLoader:
      reply(header, ask_for_loader());
      return;
    default:
      reply(header, Refusal::kUnknownMessage);
  }
}

Refusal Device::ask_for_loader() {
  if (identity_.board == protocol::BoardKind::kHost) return Refusal::kUnknownMessage;
  if (sequencer_.running()) return Refusal::kSequenceRunning;
  loader_wanted_ = true;
  return Refusal::kNone;
}

void Device::reply(const Header& header, Refusal refusal) {
  protocol::Reply message;
  message.request = header.type;
  message.refusal = refusal;
  answer(Type::kReply, header.sequence, message);
}

void Device::queue(uint8_t byte) { queue_[(queue_head_ + queue_count_++) % kQueueBytes] = byte; }

// An answer leaves room for an event, and what then does not fit is dropped whole: the host repeats its request, but
// an event is told once.
template <class Payload>
void Device::answer(Type type, uint8_t sequence, const Payload& payload) {
  if (room() >= 2 * kRoomOfFrame) send(type, sequence, payload);
}

template <class Payload>
void Device::send(Type type, uint8_t sequence, const Payload& payload) {
  uint8_t frame[protocol::kMaxOutgoingFrame];
  const size_t size = protocol::encode(type, sequence, payload, frame, sizeof frame);
  queue(0);  // a frame before it whose end was lost does not take this one along
  for (size_t i = 0; i < size; ++i) queue(frame[i]);
}

template <class Event>
bool Device::send_pending(Type type) {
  Event event;
  if (!sequencer_.take(event)) return false;
  send(type, event_sequence_++, event);
  return true;
}

// Frames first: DONE and FAULT then tell the host that it has all of them.
void Device::send_event() {
  if (room() < kRoomOfFrame) return;
  static_cast<void>(
      send_pending<protocol::FrameEvent>(Type::kFrameEvent) || send_pending<protocol::FaultEvent>(Type::kFaultEvent) ||
      send_pending<protocol::DoneEvent>(Type::kDoneEvent) || send_pending<protocol::InputsEvent>(Type::kInputsEvent));
}

// Between two frames is soon enough for the next event, and asking for each byte would take the processor's time.
bool Device::next_byte(uint8_t& byte) {
  if (queue_count_ == 0) send_event();
  if (queue_count_ == 0) return false;
  byte = queue_[queue_head_];
  queue_head_ = static_cast<uint8_t>((queue_head_ + 1) % kQueueBytes);
  --queue_count_;
  if (byte == 0) send_event();
  return true;
}

}  // namespace core
}  // namespace beltpick
