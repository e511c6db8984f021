// Who answers on the line, played by a thread at the other end of a pseudo-terminal.
#include <poll.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <thread>

#include "boot/seal.hpp"
#include "boot/stk500.hpp"
#include "flash/peer.hpp"
#include "host/pseudo_terminal.hpp"

using namespace beltpick;
using namespace beltpick::flash;
using Bytes = std::vector<std::uint8_t>;

namespace {

// Answers each byte by what `answer` makes of it.
class OtherEnd {
 public:
  explicit OtherEnd(std::function<Bytes(std::uint8_t)> answer) : answer_(std::move(answer)) {
    thread_ = std::thread([this] { serve(); });
  }
  ~OtherEnd() {
    stopping_ = true;
    thread_.join();
  }

  [[nodiscard]] const std::string& tty() const { return terminal_.tty(); }

 private:
  void serve() {
    while (!stopping_) {
      pollfd wait{terminal_.fd(), POLLIN, 0};
      ::poll(&wait, 1, 20);
      std::uint8_t bytes[64];
      const std::size_t count = terminal_.read(bytes, sizeof bytes);
      for (std::size_t i = 0; i < count; ++i) {
        const Bytes reply = answer_(bytes[i]);
        terminal_.write(reply.data(), reply.size());
      }
    }
  }

  host::PseudoTerminal terminal_{""};
  std::function<Bytes(std::uint8_t)> answer_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

Bytes frame(const Bytes& message) {
  std::uint8_t wire[protocol::kMaxFrame];
  return {wire, wire + protocol::encode_frame(message.data(), message.size(), wire, sizeof wire)};
}

// A firmware of protocol version 9, whose IDENTITY has more in it than ours.
class Firmware9 {
 public:
  Bytes operator()(std::uint8_t byte) {
    if (decoder_.push(byte) != protocol::FrameDecoder::Outcome::kMessage) return {};
    const std::uint8_t* request = decoder_.message();
    if (request[0] != 9) return frame({9, 0x80, request[2], request[1], 3});
    if (request[1] == 0x01) return frame({9, 0x81, request[2], 2, 4, 5, 6, 1, 2, 3, 4, 5, 6, 7, 8, 9});
    if (request[1] == 0x08) return frame({9, 0x80, request[2], request[1], 0});
    return {};
  }

 private:
  protocol::FrameDecoder decoder_;
};

// A boot loader on an ATmega2560.
class Loader {
 public:
  Bytes operator()(std::uint8_t byte) {
    const std::uint8_t before = before_;
    before_ = byte;
    if (byte != boot::stk500::kEnd) return {};
    if (before == boot::stk500::kGetSync) return {boot::stk500::kInSync, boot::stk500::kOk};
    if (before == boot::stk500::kReadSignature) return {boot::stk500::kInSync, 0x1E, 0x98, 0x01, boot::stk500::kOk};
    return {};
  }

 private:
  std::uint8_t before_ = 0;
};

Line open(const OtherEnd& end) {
  auto line = Line::open(end.tty());
  REQUIRE(line.has_value());
  return std::move(*line);
}

}  // namespace

TEST_CASE("a firmware of another protocol tells its board and version, and is sent to its loader", "[peer]") {
  const OtherEnd end{Firmware9()};
  const Line line = open(end);
  const auto peer = find_peer(line, 3000);
  REQUIRE(peer);
  CHECK(!peer->is_loader);
  CHECK(peer->protocol_version == 9);
  CHECK(!peer->speaks_our_protocol());
  CHECK(peer->chip == boot::find_chip(protocol::BoardKind::kAtmega328p));
  CHECK(peer->identity.firmware_major == 4);
  CHECK(peer->identity.firmware_minor == 5);
  CHECK(peer->identity.firmware_patch == 6);
  CHECK(ask_for_loader(line, *peer) == protocol::Refusal::kNone);
}

TEST_CASE("a boot loader tells its chip", "[peer]") {
  const OtherEnd end{Loader()};
  const auto peer = find_peer(open(end), 3000);
  REQUIRE(peer);
  CHECK(peer->is_loader);
  CHECK(peer->chip == boot::find_chip(protocol::BoardKind::kAtmega2560));
}

TEST_CASE("who answers something else, or nothing, is nobody", "[peer]") {
  const OtherEnd silent{[](std::uint8_t) { return Bytes(); }};
  CHECK(!find_peer(open(silent), 900));
  const OtherEnd echo{[](std::uint8_t byte) { return Bytes{byte}; }};
  CHECK(!find_peer(open(echo), 900));
}

TEST_CASE("a line is held by one at a time", "[peer]") {
  const OtherEnd end{[](std::uint8_t) { return Bytes(); }};
  const Line line = open(end);
  const auto second = Line::open(end.tty());
  REQUIRE(!second.has_value());
  CHECK(std::string(second.error().detail).find("test_flash") != std::string::npos);
}
