#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "projector/dlpc350_commands.hpp"
#include "projector/dlpc350_report.hpp"

using namespace beltpick::projector;

namespace {

std::vector<int> first_bytes(const Report& report, std::size_t count) {
  return {report.begin(), report.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

// The programmer's guide's own examples of a read and a write are of the curtain colour, command 0x1100.
TEST_CASE("A write and a read are laid out as the guide's examples", "[dlpc350]") {
  const std::vector<std::uint8_t> colours{0xFF, 0x01, 0xFF, 0x01, 0xFF, 0x01};
  const Message write = write_message(0x12, 0x1100, colours);
  REQUIRE(write.count == 1);
  CHECK(first_bytes(write.reports[0], 14) ==
        std::vector<int>{0x40, 0x12, 0x08, 0x00, 0x00, 0x11, 0xFF, 0x01, 0xFF, 0x01, 0xFF, 0x01, 0, 0});
  const Message read = read_message(0x11, 0x1100);
  REQUIRE(read.count == 1);
  CHECK(first_bytes(read.reports[0], 8) == std::vector<int>{0xC0, 0x11, 0x02, 0x00, 0x00, 0x11, 0, 0});
}

TEST_CASE("A long message goes on in further reports without a header", "[dlpc350]") {
  std::vector<std::uint8_t> parameters(384);  // 128 patterns
  std::iota(parameters.begin(), parameters.end(), std::uint8_t{1});
  const Message message = write_message(7, kTableData.number, parameters);
  REQUIRE(message.count == 7);  // 6 bytes of header and command and 384 = 390
  CHECK(first_bytes(message.reports[0], 7) == std::vector<int>{0x40, 7, 0x82, 0x01, 0x34, 0x1A, 1});
  CHECK(message.reports[1][0] == 59);
  std::vector<std::uint8_t> joined;
  for (std::size_t i = 0; i < message.count; ++i) {
    joined.insert(joined.end(), message.reports[i].begin(), message.reports[i].end());
  }
  CHECK(std::equal(parameters.begin(), parameters.end(), joined.begin() + 6));
  CHECK(std::all_of(joined.begin() + 390, joined.end(), [](std::uint8_t byte) { return byte == 0; }));
  CHECK(write_message(0, 0x1A34, std::vector<std::uint8_t>(58)).count == 1);
  CHECK(write_message(0, 0x1A34, std::vector<std::uint8_t>(59)).count == 2);
}

TEST_CASE("A reply's header tells error, sequence and length", "[dlpc350]") {
  const ReplyHeader good = reply_header({0xC0, 0x11, 0x06, 0x00, 0xFF});
  CHECK_FALSE(good.error());
  CHECK(good.sequence == 0x11);
  CHECK(good.length == 6);
  CHECK(reply_header({0x60, 1, 0x34, 0x12}).error());
  CHECK(reply_header({0x60, 1, 0x34, 0x12}).length == 0x1234);
}

TEST_CASE("A pattern's three bytes: trigger and number, depth and light, what comes after", "[dlpc350]") {
  PatternEntry entry;
  entry.trigger = PatternTrigger::kRisingEdge;
  entry.number = 2;
  entry.depth = 8;
  entry.leds = kLedRed | kLedGreen | kLedBlue;
  entry.black_after = true;
  entry.swap_buffer = true;
  CHECK(bytes_of(entry) == std::array<std::uint8_t, 3>{0x09, 0x78, 0x06});
  entry = {.trigger = PatternTrigger::kFallingEdge, .number = 23, .depth = 1, .leds = kLedBlue, .invert = true};
  CHECK(bytes_of(entry) == std::array<std::uint8_t, 3>{0x5E, 0x41, 0x01});
  entry = {.trigger = PatternTrigger::kContinue, .number = 0, .depth = 1, .leds = 0, .keep_trigger_out = true};
  CHECK(bytes_of(entry) == std::array<std::uint8_t, 3>{0x03, 0x01, 0x08});
  CHECK(bytes_of(std::uint32_t{0x12345678}) == std::array<std::uint8_t, 4>{0x78, 0x56, 0x34, 0x12});
}
