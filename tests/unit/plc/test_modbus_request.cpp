#include <catch2/catch.hpp>

#include <vector>

#include "base/random.hpp"
#include "plc/modbus_request.hpp"

using namespace beltpick;
using namespace beltpick::plc;

namespace {

std::vector<std::uint8_t> adu(const std::vector<std::uint8_t>& pdu) {
  std::vector<std::uint8_t> made;
  made.reserve(kMaxAduBytes);
  for (const int byte : {0, 1, 0, 0, 0, static_cast<int>(pdu.size()) + 1, 7})
    made.push_back(static_cast<std::uint8_t>(byte));
  for (const std::uint8_t byte : pdu) made.push_back(byte);
  return made;
}

ModbusException check(const std::vector<std::uint8_t>& pdu) { return check_request(adu(pdu), 16, 64).exception; }

}  // namespace

TEST_CASE("frames are found whatever the pieces they come in", "[framing]") {
  const auto whole = adu({3, 0, 0, 0, 1});
  for (std::size_t got = 0; got < whole.size(); ++got) {
    CHECK(find_frame({whole.data(), got}).state == FrameState::kIncomplete);
  }
  CHECK(find_frame(whole).state == FrameState::kWhole);
  CHECK(find_frame(whole).bytes == whole.size());
  auto two = whole;
  two.insert(two.end(), whole.begin(), whole.end());
  CHECK(find_frame(two).bytes == whole.size());
}

TEST_CASE("what is not Modbus is known as such", "[framing]") {
  auto wrong = adu({3, 0, 0, 0, 1});
  wrong[2] = 1;
  CHECK(find_frame(wrong).state == FrameState::kBroken);
  for (const int length : {0, 1, 255, 65535}) {
    auto other = adu({3, 0, 0, 0, 1});
    other[4] = static_cast<std::uint8_t>(length >> 8);
    other[5] = static_cast<std::uint8_t>(length & 255);
    CHECK(find_frame(other).state == FrameState::kBroken);
  }
}

TEST_CASE("functions, quantities and addresses are judged as the specification says", "[request]") {
  using enum ModbusException;
  CHECK(check({3, 0, 0, 0, 16}) == kNone);
  CHECK(check({3, 0, 0, 0, 17}) == kIllegalAddress);
  CHECK(check({3, 0, 0, 0, 200}) == kIllegalValue);
  CHECK(check({3, 0, 0, 0, 0}) == kIllegalValue);
  CHECK(check({3, 0xFF, 0xFF, 0, 2}) == kIllegalAddress);
  CHECK(check({4, 0, 0, 0, 64}) == kNone);
  CHECK(check({4, 0, 1, 0, 64}) == kIllegalAddress);
  CHECK(check({6, 0, 15, 1, 2}) == kNone);
  CHECK(check({6, 0, 16, 1, 2}) == kIllegalAddress);
  CHECK(check({6, 0, 1, 2}) == kIllegalValue);
  CHECK(check({16, 0, 0, 0, 2, 4, 0, 1, 0, 2}) == kNone);
  CHECK(check({16, 0, 0, 0, 2, 3, 0, 1, 0}) == kIllegalValue);
  CHECK(check({16, 0, 0, 0, 2, 4, 0, 1, 0}) == kIllegalValue);
  CHECK(check({16, 0, 15, 0, 2, 4, 0, 1, 0, 2}) == kIllegalAddress);
  CHECK(check({16}) == kIllegalValue);
  CHECK(check({23, 0, 0, 0, 4, 0, 0, 0, 1, 2, 0, 1}) == kNone);
  CHECK(check({23, 0, 0, 0, 40, 0, 0, 0, 1, 2, 0, 1}) == kIllegalAddress);
  CHECK(check({23, 0, 0, 0, 4, 0, 0, 0, 1, 2, 0}) == kIllegalValue);
  CHECK(check({23, 0}) == kIllegalValue);
  for (const int function : {0, 1, 2, 5, 7, 8, 15, 17, 22, 24, 43, 0x80, 0x83, 255}) {
    CHECK(check({static_cast<std::uint8_t>(function), 0, 0, 0, 1}) == kIllegalFunction);
  }
}

TEST_CASE("random bytes never read past their end", "[request]") {
  Random random(7);
  for (int i = 0; i < 200000; ++i) {
    std::vector<std::uint8_t> bytes(random.below(kMaxAduBytes + 1));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.below(random.below(2) != 0 ? 256 : 8));
    if (bytes.size() > 7) bytes[7] = std::vector<std::uint8_t>{3, 4, 6, 16, 23}[random.below(5)];
    const Frame frame = find_frame(bytes);
    if (frame.state != FrameState::kWhole) continue;
    REQUIRE(frame.bytes <= bytes.size());
    (void)check_request(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + frame.bytes), 16, 64);
  }
}
