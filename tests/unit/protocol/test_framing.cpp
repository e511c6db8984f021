#include <catch2/catch.hpp>
#include <cstring>
#include <vector>

#include "base/random.hpp"
#include "protocol/framing.hpp"

using namespace beltpick::protocol;
using Bytes = std::vector<std::uint8_t>;

namespace {

Bytes frame_of(const Bytes& message) {
  Bytes out(kMaxFrame);
  out.resize(encode_frame(message.data(), message.size(), out.data(), out.size()));
  return out;
}

// All messages that come out of a stream of bytes; `damaged` counts the frames that did not.
std::vector<Bytes> messages_of(FrameDecoder& decoder, const Bytes& wire, int& damaged) {
  std::vector<Bytes> messages;
  for (const std::uint8_t byte : wire) {
    const auto outcome = decoder.push(byte);
    if (outcome == FrameDecoder::Outcome::kDamaged) ++damaged;
    if (outcome == FrameDecoder::Outcome::kMessage) {
      messages.emplace_back(decoder.message(), decoder.message() + decoder.size());
    }
  }
  return messages;
}

Bytes random_message(beltpick::Random& random) {
  Bytes message(1 + random.below(kMaxMessage));
  // Few values, so that zeros and runs are frequent.
  const std::uint32_t values = 1 + random.below(256);
  for (auto& byte : message) byte = static_cast<std::uint8_t>(random.below(values));
  return message;
}

}  // namespace

TEST_CASE("the CRC is CRC-16/CCITT-FALSE", "[framing]") {
  const char* digits = "123456789";
  CHECK(crc16(reinterpret_cast<const std::uint8_t*>(digits), 9) == 0x29B1);
}

TEST_CASE("a frame has its zero at the end only, and gives its message back", "[framing]") {
  beltpick::Random random(7);
  FrameDecoder decoder;
  for (int i = 0; i < 3000; ++i) {
    const Bytes message = random_message(random);
    const Bytes wire = frame_of(message);
    REQUIRE(wire.size() == message.size() + kCrcBytes + 2);
    REQUIRE(std::memchr(wire.data(), 0, wire.size()) == &wire.back());
    int damaged = 0;
    const auto found = messages_of(decoder, wire, damaged);
    REQUIRE(damaged == 0);
    REQUIRE(found.size() == 1);
    REQUIRE(found[0] == message);
  }
}

TEST_CASE("messages too long or buffers too small are refused", "[framing]") {
  Bytes out(kMaxFrame);
  CHECK(encode_frame(Bytes(kMaxMessage + 1, 1).data(), kMaxMessage + 1, out.data(), out.size()) == 0);
  CHECK(encode_frame(Bytes(10, 1).data(), 10, out.data(), 13) == 0);
  CHECK(encode_frame(Bytes(10, 1).data(), 10, out.data(), 14) == 14);
  CHECK(encode_frame(nullptr, 0, out.data(), out.size()) == 0);
}

TEST_CASE("damage costs the damaged frame, the next one arrives", "[framing]") {
  beltpick::Random random(11);
  FrameDecoder decoder;
  int undetected = 0;
  for (int i = 0; i < 3000; ++i) {
    const Bytes message = random_message(random);
    Bytes wire = frame_of(message);
    const auto where = random.below(static_cast<std::uint32_t>(wire.size()));
    const auto other = static_cast<std::uint8_t>(1 + random.below(255));
    switch (random.below(4)) {
      case 0:
        wire[where] ^= other;
        break;
      case 1:
        wire.erase(wire.begin() + where);
        break;
      case 2:
        wire.insert(wire.begin() + where, other);
        break;
      default:
        wire.resize(where);
    }
    wire.push_back(0);
    int damaged = 0;
    for (const Bytes& found : messages_of(decoder, wire, damaged)) undetected += found != message;
    const Bytes next = random_message(random);
    const auto found = messages_of(decoder, frame_of(next), damaged);
    REQUIRE(found.size() == 1);
    REQUIRE(found[0] == next);
  }
  CHECK(undetected <= 1);  // a 16-bit CRC lets one in 65536 through
}

TEST_CASE("an endless frame overruns nothing and is reported", "[framing]") {
  FrameDecoder decoder;
  int damaged = 0;
  CHECK(messages_of(decoder, Bytes(100000, 0xFF), damaged).empty());
  CHECK(messages_of(decoder, Bytes(100000, 0x01), damaged).empty());
  CHECK(messages_of(decoder, Bytes{0, 0, 0}, damaged).empty());
  CHECK(damaged == 1);
}
