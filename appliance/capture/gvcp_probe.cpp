#include "capture/gvcp_probe.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.hpp"

namespace beltpick::capture {

namespace {
// GigE Vision 2.0, 14.1 and 16.1: command 0x0002 asks, 0x0003 answers.
constexpr std::uint16_t kGvcpPort = 3956;
constexpr std::uint8_t kKey = 0x42;
constexpr std::uint8_t kAnswerWanted = 0x01;
constexpr std::uint8_t kDiscovery = 0x02;
constexpr std::uint8_t kDiscoveryAnswer = 0x03;
}  // namespace

GvcpProbe::GvcpProbe(in_addr address) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  sockaddr_in camera{};
  camera.sin_family = AF_INET;
  camera.sin_port = htons(kGvcpPort);
  camera.sin_addr = address;
  if (socket_ >= 0 && ::connect(socket_, reinterpret_cast<const sockaddr*>(&camera), sizeof camera) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}

GvcpProbe::~GvcpProbe() {
  if (socket_ >= 0) ::close(socket_);
}

bool GvcpProbe::answers(int timeout_ms) {
  if (socket_ < 0) return true;
  if (++request_id_ == 0) ++request_id_;  // 0 is not allowed
  const auto id_high = static_cast<std::uint8_t>(request_id_ >> 8U);
  const auto id_low = static_cast<std::uint8_t>(request_id_ & 0xFFU);
  const std::uint8_t request[8] = {kKey, kAnswerWanted, 0, kDiscovery, 0, 0, id_high, id_low};
  if (::send(socket_, request, sizeof request, 0) != sizeof request) return false;
  const std::int64_t until_us = monotonic_us() + timeout_ms * std::int64_t{1000};
  while (true) {
    const std::int64_t left_us = until_us - monotonic_us();
    pollfd wait{socket_, POLLIN, 0};
    if (left_us <= 0 || ::poll(&wait, 1, static_cast<int>(left_us / 1000) + 1) <= 0) return false;
    std::uint8_t answer[512];
    const ssize_t size = ::recv(socket_, answer, sizeof answer, 0);
    if (size < 0) return false;  // the host is there, but nobody listens on the port
    if (size >= 8 && answer[3] == kDiscoveryAnswer && answer[6] == id_high && answer[7] == id_low) return true;
  }
}

}  // namespace beltpick::capture
