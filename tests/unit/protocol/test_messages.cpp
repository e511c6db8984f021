#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "protocol/messages.hpp"

using namespace beltpick::protocol;

namespace {

std::vector<std::uint8_t> unframed(const std::uint8_t* wire, std::size_t size) {
  FrameDecoder decoder;
  for (std::size_t i = 0; i < size; ++i) {
    if (decoder.push(wire[i]) == FrameDecoder::Outcome::kMessage) {
      return {decoder.message(), decoder.message() + decoder.size()};
    }
  }
  return {};
}

template <class Payload>
std::vector<std::uint8_t> message_of(Type type, std::uint8_t sequence, const Payload& payload) {
  std::uint8_t wire[kMaxFrame];
  return unframed(wire, encode(type, sequence, payload, wire, sizeof wire));
}

Arm full_arm() {
  Arm arm;
  arm.arm_id = 0x1234;
  arm.host_silence_ms = 500;
  arm.strobe_tolerance_us = 0x01020304;
  arm.group_count = kMaxGroups;
  for (std::uint8_t i = 0; i < kMaxGroups; ++i) {
    arm.groups[i].frames = static_cast<std::uint16_t>(i + 1);
    arm.groups[i].settle_us = 1000U + i;
    arm.groups[i].exposure_us = 8000U + i;
    arm.groups[i].period_us = 16666U + i;
    arm.groups[i].readout_us = 4000U + i;
    arm.groups[i].overlap_gap_us = static_cast<std::uint16_t>(10U + i);
  }
  return arm;
}

}  // namespace

TEST_CASE("fields lie on the wire little-endian, in the order PROTOCOL.md gives", "[messages]") {
  FrameEvent event;
  event.arm_id = 0x0201;
  event.frame = 0x0403;
  event.trigger_number = 0x08070605;
  event.pulse_ticks = 0x0C0B0A09;
  event.strobe_ticks = 0x100F0E0D;
  event.strobe_length_ticks = 0x14131211;
  const auto message = message_of(Type::kFrameEvent, 9, event);
  REQUIRE(message.size() == 23);
  CHECK(message[0] == kVersion);
  CHECK(message[1] == 0xA0);
  CHECK(message[2] == 9);
  for (std::uint8_t i = 1; i <= 20; ++i) CHECK(message[2U + i] == i);
}

TEST_CASE("the longest ARM fits and comes back as it was", "[messages]") {
  const Arm sent = full_arm();
  const auto message = message_of(Type::kArm, 200, sent);
  REQUIRE(message.size() == kHeaderBytes + 9 + kMaxGroups * 20);
  Header header;
  REQUIRE(decode_header(message.data(), message.size(), header));
  CHECK(header.type == Type::kArm);
  CHECK(header.sequence == 200);
  Arm found;
  REQUIRE(decode_payload(message.data(), message.size(), found));
  CHECK(found.strobe_tolerance_us == sent.strobe_tolerance_us);
  CHECK(found.groups[7].readout_us == 4007);
  CHECK(found.groups[7].overlap_gap_us == 17);
  CHECK(message_of(Type::kArm, 200, found) == message);
}

TEST_CASE("a payload of another length is refused", "[messages]") {
  auto message = message_of(Type::kArm, 1, full_arm());
  Arm arm;
  for (std::size_t size = 0; size < message.size(); ++size) CHECK_FALSE(decode_payload(message.data(), size, arm));
  message.push_back(0);
  CHECK_FALSE(decode_payload(message.data(), message.size(), arm));
}

TEST_CASE("an ARM that claims more groups than it may is read without overrun and refused", "[messages]") {
  Arm arm = full_arm();
  arm.group_count = 255;
  const auto message = message_of(Type::kArm, 1, arm);
  Arm found;
  CHECK(decode_payload(message.data(), message.size(), found));  // as many groups as a buffer holds; the count tells
  CHECK(found.group_count == 255);
}

TEST_CASE("whatever the firmware sends fits its frame", "[messages]") {
  std::uint8_t wire[kMaxFrame];
  CHECK(encode(Type::kReply, 0, Reply(), wire, kMaxOutgoingFrame) > 0);
  CHECK(encode(Type::kIdentity, 0, Identity(), wire, kMaxOutgoingFrame) > 0);
  CHECK(encode(Type::kStatusReport, 0, StatusReport(), wire, kMaxOutgoingFrame) > 0);
  CHECK(encode(Type::kFrameEvent, 0, FrameEvent(), wire, kMaxOutgoingFrame) > 0);
  CHECK(encode(Type::kDoneEvent, 0, DoneEvent(), wire, kMaxOutgoingFrame) > 0);
  CHECK(encode(Type::kFaultEvent, 0, FaultEvent(), wire, kMaxOutgoingFrame) > 0);
  CHECK(encode(Type::kInputsEvent, 0, InputsEvent(), wire, kMaxOutgoingFrame) > 0);
}

TEST_CASE("faults and refusals stand in their tables at their numbers", "[messages]") {
  for (std::uint8_t n = 1; n <= kFaultCount; ++n) {
    const FaultEntry* entry = find_fault(static_cast<Fault>(n));
    REQUIRE(entry != nullptr);
    CHECK(entry->fault == static_cast<Fault>(n));
    CHECK(std::strlen(entry->remedy) > 0);
  }
  CHECK(find_fault(Fault::kNone) == nullptr);
  CHECK(find_fault(static_cast<Fault>(kFaultCount + 1)) == nullptr);
  for (std::uint8_t n = 1; n <= kRefusalCount; ++n) CHECK(kRefusalTable[n - 1].refusal == static_cast<Refusal>(n));
  CHECK(std::string(refusal_text(Refusal::kPeriodTooShort)).find("period") == 0);
}

TEST_CASE("PROTOCOL.md lists every fault under its number", "[messages]") {
  std::ifstream file(BELTPICK_SOURCE_DIR "/trigger_fw/protocol/PROTOCOL.md");
  const std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  REQUIRE_FALSE(page.empty());
  for (const FaultEntry& entry : kFaultTable) {
    const std::string row = "| " + std::to_string(static_cast<int>(entry.fault)) + " | " + entry.name + " |";
    INFO(row);
    CHECK(page.find(row) != std::string::npos);
  }
}
