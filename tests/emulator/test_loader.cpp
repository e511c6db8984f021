// The boot loader's own manners, in the emulator's time.
#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>

#include "boot/stk500.hpp"
#include "emulator/flash_files.hpp"
#include "protocol/messages.hpp"

using namespace emulator;
namespace stk500 = boot::stk500;

namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes kAnswered = {stk500::kInSync, stk500::kOk};
const Bytes kSync = {stk500::kGetSync, stk500::kEnd};

class Board {
 public:
  Board(Mcu of, const std::vector<std::string>& kinds) : mcu(of), chip(of, image_of(kinds, of)) {
    chip.on_edge = [this](const PinEdge& edge) { rises += edge.level ? 1 : 0; };
  }

  const Mcu mcu;
  Chip chip;
  int rises = 0;  // of outputs

  // Sends the bytes at the line's speed; what came back `ms` later.
  Bytes ask(const Bytes& bytes, std::uint64_t ms = 30) {
    chip.received();
    chip.send(bytes);
    chip.run_us(ms * 1000);
    return chip.received();
  }

  Bytes program_page(std::uint32_t at, const Bytes& data) {
    const auto words = static_cast<std::uint16_t>(at / 2);
    ask({stk500::kUniversal, stk500::kUniversalExtendedAddress, 0, static_cast<std::uint8_t>(at >> 17U), 0,
         stk500::kEnd});
    ask({stk500::kLoadAddress, static_cast<std::uint8_t>(words & 0xFFU), static_cast<std::uint8_t>(words >> 8U),
         stk500::kEnd});
    return ask(page_request(data), 60);
  }
  static Bytes page_request(const Bytes& data) {
    Bytes request = {stk500::kProgramPage, static_cast<std::uint8_t>(data.size() >> 8U),
                     static_cast<std::uint8_t>(data.size() & 0xFFU), stk500::kMemoryFlash};
    std::copy(data.begin(), data.end(), std::back_inserter(request));
    request.push_back(stk500::kEnd);
    return request;
  }

  bool loader_answers() { return ask(kSync) == kAnswered; }

  bool firmware_answers() { return identify().has_value(); }
  std::optional<protocol::Identity> identify() {
    protocol::FrameDecoder decoder;
    for (const std::uint8_t byte : ask(request(protocol::Type::kIdentify))) {
      protocol::Identity identity;
      if (decoder.push(byte) == protocol::FrameDecoder::Outcome::kMessage &&
          protocol::decode_payload(decoder.message(), decoder.size(), identity)) {
        return identity;
      }
    }
    return std::nullopt;
  }

  static Bytes request(protocol::Type type) {
    std::uint8_t wire[32] = {0};
    const std::size_t size = protocol::encode(type, 1, protocol::Empty(), wire + 1, sizeof wire - 1);
    return {wire, wire + 1 + size};
  }
};

Mcu any_mcu() { return GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p); }

}  // namespace

TEST_CASE("without a firmware the loader answers, for as long as it takes", "[loader]") {
  Board board(any_mcu(), {"boot"});
  CHECK(board.loader_answers());
  const auto& signature = layout(board.mcu).signature;
  CHECK(board.ask({stk500::kReadSignature, stk500::kEnd}) ==
        Bytes{stk500::kInSync, signature[0], signature[1], signature[2], stk500::kOk});
  board.chip.run_us(11'000'000);
  CHECK(board.loader_answers());
  CHECK(board.rises == 0);
}

TEST_CASE("a whole firmware is started at once after power-up", "[loader]") {
  Board board(any_mcu(), {"boot", "trigger"});
  board.chip.power_cycle(1);
  board.chip.run_us(400'000);
  const auto identity = board.identify();
  REQUIRE(identity);
  CHECK(identity->reset_cause == protocol::kResetPowerOn);
  CHECK(identity->flash_state == protocol::FlashState::kWhole);
}

TEST_CASE("after a reset by the pin the loader waits a second for avrdude", "[loader]") {
  Board board(any_mcu(), {"boot", "trigger"});
  board.chip.reset_by_pin();
  board.chip.run_us(600'000);
  CHECK(board.loader_answers());
  board.chip.reset_by_pin();
  board.chip.run_us(1'300'000);
  const auto identity = board.identify();
  REQUIRE(identity);
  CHECK(identity->reset_cause == protocol::kResetExternal);
}

TEST_CASE("whoever speaks to the firmware does not wait for that second", "[loader]") {
  Board board(any_mcu(), {"boot", "trigger"});
  board.chip.reset_by_pin();
  board.chip.run_us(50'000);
  CHECK(!board.firmware_answers());  // the loader took this one as its sign to go
  board.chip.run_us(400'000);
  CHECK(board.firmware_answers());
}

TEST_CASE("the firmware hands over to the loader, and comes back without a fault when nobody speaks", "[loader]") {
  Board board(any_mcu(), {"boot", "trigger"});
  board.ask(Board::request(protocol::Type::kEnterLoader), 400);
  CHECK(board.loader_answers());
  board.chip.run_us(10'500'000);
  const auto identity = board.identify();
  REQUIRE(identity);
  CHECK(identity->reset_cause == protocol::kResetExternal);
  CHECK(board.rises == 0);
}

TEST_CASE("the first page of another firmware ends the one that is there", "[loader]") {
  Board board(any_mcu(), {"boot", "trigger"});
  board.ask(Board::request(protocol::Type::kEnterLoader), 400);
  const Bytes page(layout(board.mcu).page_bytes, 0x12);
  CHECK(board.program_page(0, page) == kAnswered);
  CHECK(board.chip.flash_byte(5) == 0x12);
  board.chip.power_cycle(2);
  board.chip.run_us(400'000);
  CHECK(board.loader_answers());
  CHECK(board.rises == 0);
}

TEST_CASE("the loader never writes itself, nor across a page", "[loader]") {
  Board board(any_mcu(), {"boot"});
  const boot::ChipLayout& chip = layout(board.mcu);
  const boot::FlashImage before = image_of({"boot"}, board.mcu);
  const Bytes refused = {stk500::kInSync, stk500::kFailed};
  const Bytes page(chip.page_bytes, 0x12);
  REQUIRE(board.loader_answers());
  CHECK(board.ask(Board::page_request(page), 60) == refused);  // no address yet
  for (std::uint32_t at = chip.loader_start; at < chip.flash_bytes; at += chip.page_bytes) {
    CHECK(board.program_page(at, page) == refused);
  }
  CHECK(board.program_page(2, page) == refused);
  CHECK(board.program_page(0, Bytes(chip.page_bytes + 2U, 0x12)) == refused);
  for (std::uint32_t at = 0; at < chip.flash_bytes; ++at) {
    if (board.chip.flash_byte(at) != before.byte(at)) FAIL("written at " << at);
  }
  CHECK(board.program_page(chip.loader_start - chip.page_bytes, page) == kAnswered);
}

TEST_CASE("a request that breaks off does not swallow the next", "[loader]") {
  Board board(any_mcu(), {"boot"});
  REQUIRE(board.loader_answers());
  Bytes half = {stk500::kProgramPage, 0, 128, stk500::kMemoryFlash};
  half.resize(64, 0x34);
  CHECK(board.ask(half, 400).empty());
  CHECK(board.loader_answers());
  CHECK(board.chip.flash_byte(0) == 0xFF);
  CHECK(board.ask({stk500::kGetSync, 0x77}) == Bytes{stk500::kNoSync});
  CHECK(board.ask({0x00}).empty());
  CHECK(board.loader_answers());
}
