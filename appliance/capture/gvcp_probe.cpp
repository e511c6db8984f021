#include "capture/gvcp_probe.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "base/clock.hpp"

namespace beltpick::capture {

namespace {
// GigE Vision 2.0, 14.1, 16.1, 16.2 and 28: a command's acknowledge is numbered one above it.
constexpr std::uint16_t kGvcpPort = 3956;
constexpr std::uint8_t kKey = 0x42;
constexpr std::uint8_t kAnswerWanted = 0x01;
constexpr std::uint8_t kDiscovery = 0x02;
constexpr std::uint8_t kReadRegister = 0x80;
constexpr std::size_t kHeaderBytes = 8;
constexpr unsigned kAccessDenied = 0x8006;
constexpr std::uint32_t kControlPrivilege = 0x0a00;
constexpr std::uint32_t kExclusive = 1U;
constexpr std::uint32_t kControl = 2U;
constexpr std::uint32_t kControllerAddress = 0x0a18;
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

std::size_t GvcpProbe::ask(std::uint8_t command, std::span<const std::uint8_t> payload, std::span<std::uint8_t> answer,
                           int timeout_ms) {
  if (++request_id_ == 0) ++request_id_;  // 0 is not allowed
  const auto id_high = static_cast<std::uint8_t>(request_id_ >> 8U);
  const auto id_low = static_cast<std::uint8_t>(request_id_ & 0xFFU);
  std::array<std::uint8_t, kHeaderBytes + 8> request{
      kKey, kAnswerWanted, 0, command, 0, static_cast<std::uint8_t>(payload.size()), id_high, id_low};
  std::copy(payload.begin(), payload.end(), request.begin() + kHeaderBytes);
  const std::size_t bytes = kHeaderBytes + payload.size();
  if (::send(socket_, request.data(), bytes, 0) != static_cast<ssize_t>(bytes)) return 0;
  const std::int64_t until_us = monotonic_us() + timeout_ms * std::int64_t{1000};
  while (true) {
    const std::int64_t left_us = until_us - monotonic_us();
    pollfd wait{socket_, POLLIN, 0};
    if (left_us <= 0 || ::poll(&wait, 1, static_cast<int>(left_us / 1000) + 1) <= 0) return 0;
    const ssize_t size = ::recv(socket_, answer.data(), answer.size(), 0);
    if (size < 0) return 0;  // the host is there, but nobody listens on the port
    const bool acknowledges = size >= static_cast<ssize_t>(kHeaderBytes) && answer[3] == command + 1;
    if (acknowledges && answer[6] == id_high && answer[7] == id_low) return static_cast<std::size_t>(size);
  }
}

bool GvcpProbe::answers(int timeout_ms) {
  std::array<std::uint8_t, 512> answer;
  return socket_ < 0 || ask(kDiscovery, {}, answer, timeout_ms) > 0;
}

std::optional<std::uint32_t> GvcpProbe::read_register(std::uint32_t address, int timeout_ms) {
  const auto byte = [address](unsigned shift) { return static_cast<std::uint8_t>(address >> shift); };
  const std::array<std::uint8_t, 4> payload{byte(24), byte(16), byte(8), byte(0)};
  std::array<std::uint8_t, 64> answer{};
  const std::size_t size = ask(kReadRegister, payload, answer, timeout_ms);
  const unsigned status = static_cast<unsigned>(answer[0]) << 8U | answer[1];
  if (size == 0) return std::nullopt;
  if (status == kAccessDenied) return kExclusive;  // nobody but the controlling program may even read
  if (status != 0 || size < kHeaderBytes + 4) return 0;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | answer[kHeaderBytes + i];
  return value;
}

std::optional<GvcpProbe::Controller> GvcpProbe::controller(int timeout_ms) {
  if (socket_ < 0) return std::nullopt;
  const auto privilege = read_register(kControlPrivilege, timeout_ms);
  if (!privilege) return std::nullopt;
  Controller controller{(*privilege & (kExclusive | kControl)) != 0, {}};
  if (controller.there) {
    const std::uint32_t address = read_register(kControllerAddress, timeout_ms).value_or(0);
    if (address != kExclusive) controller.address.s_addr = htonl(address);
  }
  return controller;
}

}  // namespace beltpick::capture
