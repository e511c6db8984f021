#include <catch2/catch.hpp>
#include <vector>

#include "bench.hpp"
#include "core/device.hpp"

using namespace bench;
using protocol::Refusal;
using protocol::Type;

namespace {

struct Message {
  protocol::Header header;
  std::vector<std::uint8_t> bytes;

  template <class Payload>
  Payload as() const {
    Payload payload;
    REQUIRE(protocol::decode_payload(bytes.data(), bytes.size(), payload));
    return payload;
  }
};

// The host's end of the wire.
class Host {
 public:
  explicit Host(core::Device& device) : device_(device) {}

  template <class Payload>
  void send(Type type, std::uint8_t sequence, const Payload& payload, std::uint32_t now_us = 0) {
    std::uint8_t wire[protocol::kMaxFrame];
    const std::size_t size = protocol::encode(type, sequence, payload, wire, sizeof wire);
    for (std::size_t i = 0; i < size; ++i) device_.on_byte(wire[i], core::ticks_of(now_us));
  }

  std::vector<Message> receive() {
    std::vector<Message> messages;
    std::uint8_t byte = 0;
    while (device_.next_byte(byte)) {
      if (decoder_.push(byte) != protocol::FrameDecoder::Outcome::kMessage) continue;
      Message message;
      message.bytes.assign(decoder_.message(), decoder_.message() + decoder_.size());
      REQUIRE(protocol::decode_header(message.bytes.data(), message.bytes.size(), message.header));
      messages.push_back(message);
    }
    return messages;
  }

  // The refusal of the single reply to the request just sent.
  Refusal answer(Type request, std::uint8_t sequence) {
    const auto messages = receive();
    REQUIRE(messages.size() == 1);
    CHECK(messages[0].header.type == Type::kReply);
    CHECK(messages[0].header.sequence == sequence);
    CHECK(messages[0].as<protocol::Reply>().request == request);
    return messages[0].as<protocol::Reply>().refusal;
  }

 private:
  core::Device& device_;
  protocol::FrameDecoder decoder_;
};

}  // namespace

TEST_CASE("a capture over the wire: identify, arm, start, frames, done", "[device]") {
  protocol::Identity identity;
  identity.firmware_minor = 7;
  core::Device device(identity, kStands, 0);
  Host host(device);
  host.send(Type::kIdentify, 1, protocol::Empty());
  auto messages = host.receive();
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].header.type == Type::kIdentity);
  CHECK(messages[0].header.sequence == 1);
  CHECK(messages[0].as<protocol::Identity>().firmware_minor == 7);

  host.send(Type::kArm, 2, sequence(40, 2));
  CHECK(host.answer(Type::kArm, 2) == Refusal::kNone);
  host.send(Type::kStart, 3, protocol::Start{40}, 500);
  CHECK(host.answer(Type::kStart, 3) == Refusal::kNone);
  for (std::uint32_t t = 500; t <= 500 + 25000; t += 50) {
    device.sequencer().on_time(core::ticks_of(t));
    device.sequencer().on_strobe(device.sequencer().outputs().camera, core::ticks_of(t));
  }
  messages = host.receive();
  REQUIRE(messages.size() == 3);
  for (std::uint8_t i = 0; i < 3; ++i) CHECK(messages[i].header.sequence == i);
  CHECK(messages[1].as<protocol::FrameEvent>().frame == 1);
  CHECK(messages[2].header.type == Type::kDoneEvent);
  CHECK(messages[2].as<protocol::DoneEvent>().arm_id == 40);

  host.send(Type::kStatus, 9, protocol::Empty(), 4711);
  const auto status = host.receive().at(0).as<protocol::StatusReport>();
  CHECK(status.state == protocol::State::kDone);
  CHECK(status.trigger_number == 2);
  CHECK(status.now_ticks == core::ticks_of(4711));
}

TEST_CASE("the identity tells the limits that the board has", "[device]") {
  core::BoardTiming board;
  board.min_exposure_us = 60;
  board.min_period_us = 500;
  board.min_interval_us = 50;
  core::Device device(protocol::Identity(), kStands, 0, board);
  Host host(device);
  host.send(Type::kIdentify, 1, protocol::Empty());
  const auto identity = host.receive().at(0).as<protocol::Identity>();
  CHECK(identity.tick_ns == core::kTick_ns);
  CHECK(identity.min_exposure_us == 60);
  CHECK(identity.max_exposure_us == protocol::kMaxExposure_us);
  CHECK(identity.min_period_us == 500);
  CHECK(identity.max_period_us == protocol::kMaxPeriod_us);
  CHECK(identity.min_interval_us == 50);
}

TEST_CASE("why the firmware started may be a fault, told at once and latched", "[device]") {
  struct Start {
    std::uint8_t cause;
    protocol::Fault fault;
  };
  const auto start =
      GENERATE(Start{protocol::kResetBrownOut, protocol::Fault::kBrownOut},
               Start{protocol::kResetWatchdog, protocol::Fault::kWatchdogReset},
               Start{protocol::kResetPowerOn | protocol::kResetBrownOut, protocol::Fault::kNone},
               Start{protocol::kResetExternal, protocol::Fault::kNone}, Start{0, protocol::Fault::kNone});
  protocol::Identity identity;
  identity.reset_cause = start.cause;
  core::Device device(identity, kStands, 0);
  Host host(device);
  INFO("reset cause " << int{start.cause});
  CHECK(device.sequencer().status(0).fault == start.fault);
  const auto told = host.receive();
  REQUIRE(told.size() == (start.fault == protocol::Fault::kNone ? 0 : 1));
  if (!told.empty()) CHECK(told[0].as<protocol::FaultEvent>().fault == start.fault);
  host.send(Type::kClear, 1, protocol::Empty());
  CHECK(host.answer(Type::kClear, 1) == Refusal::kNone);
  host.send(Type::kArm, 2, sequence(1, 2));
  CHECK(host.answer(Type::kArm, 2) == Refusal::kNone);
}

TEST_CASE("a damaged program is a fault that CLEAR does not end", "[device]") {
  protocol::Identity identity;
  identity.flash_state = protocol::FlashState::kDamaged;
  identity.reset_cause = protocol::kResetWatchdog;
  core::Device device(identity, kStands, 0);
  Host host(device);
  CHECK(device.sequencer().status(0).fault == protocol::Fault::kFlashDamaged);
  CHECK(host.receive().size() == 1);
  host.send(Type::kClear, 1, protocol::Empty());
  CHECK(host.answer(Type::kClear, 1) == Refusal::kFlashDamaged);
  host.send(Type::kArm, 2, sequence(1, 2));
  CHECK(host.answer(Type::kArm, 2) == Refusal::kFaultLatched);
}

TEST_CASE("wrong messages are refused with their reason", "[device]") {
  core::Device device(protocol::Identity(), kStands, 0);
  Host host(device);
  host.send(static_cast<Type>(0x33), 1, protocol::Empty());
  CHECK(host.answer(static_cast<Type>(0x33), 1) == Refusal::kUnknownMessage);
  host.send(Type::kArm, 2, protocol::Empty());
  CHECK(host.answer(Type::kArm, 2) == Refusal::kMalformed);
  host.send(Type::kStart, 3, protocol::Empty());
  CHECK(host.answer(Type::kStart, 3) == Refusal::kMalformed);
  host.send(Type::kAbort, 4, protocol::Start());
  CHECK(host.answer(Type::kAbort, 4) == Refusal::kMalformed);
  auto too_many = sequence(1, 1);
  too_many.group_count = protocol::kMaxGroups + 1;
  host.send(Type::kArm, 5, too_many);
  CHECK(host.answer(Type::kArm, 5) == Refusal::kTooManyGroups);
}

TEST_CASE("another version of the protocol is refused, not guessed at", "[device]") {
  core::Device device(protocol::Identity(), kStands, 0);
  Host host(device);
  const std::uint8_t message[] = {protocol::kVersion + 1, static_cast<std::uint8_t>(Type::kIdentify), 6};
  std::uint8_t wire[16];
  const std::size_t size = protocol::encode_frame(message, sizeof message, wire, sizeof wire);
  for (std::size_t i = 0; i < size; ++i) device.on_byte(wire[i], 0);
  CHECK(host.answer(Type::kIdentify, 6) == Refusal::kWrongVersion);
}

TEST_CASE("KEEPALIVE keeps a sequence alive, CLEAR ends a fault, ABORT a sequence", "[device]") {
  core::Device device(protocol::Identity(), kStands, 0);
  Host host(device);
  auto arm = sequence(1, 5);
  arm.host_silence_ms = 2;
  host.send(Type::kArm, 1, arm);
  host.send(Type::kStart, 2, protocol::Start{1}, 0);
  host.receive();
  device.sequencer().on_time(core::ticks_of(100));
  device.sequencer().on_time(core::ticks_of(1000));
  device.sequencer().on_strobe(true, core::ticks_of(1000));
  host.send(Type::kKeepalive, 3, protocol::Empty(), 1500);
  CHECK(host.answer(Type::kKeepalive, 3) == Refusal::kNone);
  device.sequencer().on_time(core::ticks_of(3499));
  CHECK(device.sequencer().status(0).state == protocol::State::kRunning);
  device.sequencer().on_time(core::ticks_of(3500));
  const auto messages = host.receive();
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].as<protocol::FaultEvent>().fault == protocol::Fault::kHostSilent);
  host.send(Type::kClear, 4, protocol::Empty());
  CHECK(host.answer(Type::kClear, 4) == Refusal::kNone);
  host.send(Type::kAbort, 5, protocol::Empty());
  CHECK(host.answer(Type::kAbort, 5) == Refusal::kNone);
  CHECK(device.sequencer().status(0).state == protocol::State::kIdle);
}

TEST_CASE("the boot loader is entered once the reply is out, and not out of a sequence", "[device]") {
  protocol::Identity identity;
  identity.board = protocol::BoardKind::kAtmega328p;
  core::Device device(identity, kStands, 0);
  Host host(device);
  host.send(Type::kArm, 1, sequence(1, 5));
  host.send(Type::kStart, 2, protocol::Start{1}, 0);
  host.receive();
  host.send(Type::kEnterLoader, 3, protocol::Empty());
  CHECK(host.answer(Type::kEnterLoader, 3) == Refusal::kSequenceRunning);
  CHECK(!device.loader_due());
  device.sequencer().abort();
  CHECK(!device.loader_due());
  host.send(Type::kEnterLoader, 4, protocol::Empty());
  CHECK(!device.loader_due());
  CHECK(host.answer(Type::kEnterLoader, 4) == Refusal::kNone);
  CHECK(device.loader_due());
}

TEST_CASE("a board without a boot loader does not know the request", "[device]") {
  core::Device device(protocol::Identity(), kStands, 0);
  Host host(device);
  host.send(Type::kEnterLoader, 1, protocol::Empty());
  CHECK(host.answer(Type::kEnterLoader, 1) == Refusal::kUnknownMessage);
  CHECK(!device.loader_due());
}

TEST_CASE("a host that asks for more than the line carries loses answers, not the frames of the sequence", "[device]") {
  core::Device device(protocol::Identity(), kStands, 0);
  Host host(device);
  auto arm = sequence(1, 30);
  arm.groups[0] = {30, 300, 700, 1500, 700, 0};
  host.send(Type::kArm, 1, arm);
  host.send(Type::kStart, 2, protocol::Start{1});
  std::vector<std::uint8_t> line;
  for (std::uint32_t us = 0; us < 30 * 1500; us += 20) {  // 20 us are a byte of the line
    device.sequencer().on_time(core::ticks_of(us));
    device.sequencer().on_strobe(device.sequencer().outputs().camera, core::ticks_of(us));
    if (us % 400 == 0) host.send(Type::kStatus, 3, protocol::Empty(), us);
    std::uint8_t byte = 0;
    if (device.next_byte(byte)) line.push_back(byte);
  }
  for (std::uint8_t byte = 0; device.next_byte(byte);) line.push_back(byte);
  protocol::FrameDecoder decoder;
  int frames = 0, answers = 0;
  for (const std::uint8_t byte : line) {
    if (decoder.push(byte) != protocol::FrameDecoder::Outcome::kMessage) continue;
    frames += decoder.message()[1] == static_cast<std::uint8_t>(Type::kFrameEvent) ? 1 : 0;
    answers += decoder.message()[1] == static_cast<std::uint8_t>(Type::kStatusReport) ? 1 : 0;
  }
  CHECK(device.sequencer().status(0).fault == protocol::Fault::kNone);
  CHECK(frames == 30);
  CHECK(answers > 20);
}

TEST_CASE("a host that asks without listening gets whole answers or none", "[device]") {
  core::Device device(protocol::Identity(), kStands, 0);
  Host host(device);
  for (std::uint8_t i = 0; i < 100; ++i) host.send(Type::kStatus, i, protocol::Empty());
  const auto messages = host.receive();
  CHECK(messages.size() >= 3);
  for (std::uint8_t i = 0; i < messages.size(); ++i) CHECK(messages[i].header.sequence == i);
  host.send(Type::kStatus, 200, protocol::Empty());
  CHECK(host.receive().size() == 1);
}
