#include "virtual_cell/gige/control_channel.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "virtual_cell/gige/registers.hpp"

namespace beltpick::virtual_cell::gige {
namespace {

constexpr int kPollMs = 20;
constexpr std::size_t kMaxMessageBytes = 576;  // GVCP never exceeds the smallest IP datagram
constexpr std::uint8_t kAnswerWanted = 0x01;

}  // namespace

Result<std::unique_ptr<ControlChannel>> ControlChannel::open(std::uint32_t ip, RegisterBank& bank,
                                                             ControlEvents events) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(kGvcpPort);
  address.sin_addr.s_addr = htonl(ip);
  if (fd < 0 || ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int reason = errno;
    if (fd >= 0) ::close(fd);
    return failure(ResultCode::kServiceUnreachable,
                   "virtual camera: cannot listen on %u.%u.%u.%u UDP port %u: %s; give it another loopback address",
                   ip >> 24U, (ip >> 16U) & 255U, (ip >> 8U) & 255U, ip & 255U, unsigned{kGvcpPort},
                   std::strerror(reason));
  }
  std::unique_ptr<ControlChannel> channel(new ControlChannel(fd, bank, std::move(events)));
  channel->thread_ = std::thread([raw = channel.get()] { raw->run(); });
  return channel;
}

ControlChannel::ControlChannel(int socket, RegisterBank& bank, ControlEvents events)
    : socket_(socket), bank_(bank), events_(std::move(events)) {}

ControlChannel::~ControlChannel() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  ::close(socket_);
}

void ControlChannel::run() {
  pollfd waiting{socket_, POLLIN, 0};
  while (!stop_) {
    if (::poll(&waiting, 1, kPollMs) > 0) receive();
    check_heartbeat();
  }
}

void ControlChannel::receive() {
  std::array<std::uint8_t, kMaxMessageBytes> bytes{};
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t count =
      ::recvfrom(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
  if (silent_ || count < static_cast<ssize_t>(kGvcpHeaderBytes) || bytes[0] != kGvcpCommand) return;
  const std::size_t length = get16(bytes.data() + 4);
  if (length > static_cast<std::size_t>(count) - kGvcpHeaderBytes) return;
  handle({static_cast<GvcpMessage>(get16(bytes.data() + 2)),
          get16(bytes.data() + 6),
          (bytes[1] & kAnswerWanted) != 0,
          {bytes.data() + kGvcpHeaderBytes, length}},
         from);
}

void ControlChannel::check_heartbeat() {
  if (controller_.ip == 0) return;
  const std::int64_t timeout_us = 1000LL * bank_.get(address::kHeartbeatTimeoutMs);
  if (monotonic_us() - controller_.heard_us > timeout_us || silent_) release_control();
}

void ControlChannel::release_control() {
  controller_ = {};
  bank_.set(address::kControlPrivilege, 0);
  if (events_.control_lost) events_.control_lost();
}

bool ControlChannel::is_controller(const sockaddr_in& from) const {
  return controller_.ip == from.sin_addr.s_addr && controller_.port == from.sin_port;
}

void ControlChannel::handle(const Request& request, const sockaddr_in& from) {
  if (is_controller(from)) controller_.heard_us = monotonic_us();
  std::vector<std::uint8_t> data;
  GevStatus status = GevStatus::kSuccess;
  switch (request.message) {
    case GvcpMessage::kDiscovery:
      data.resize(address::kDiscoverySize);
      status = bank_.read(0, data);
      break;
    case GvcpMessage::kReadRegister:
      status = read_registers(request, data);
      break;
    case GvcpMessage::kReadMemory:
      status = read_memory(request, data);
      break;
    case GvcpMessage::kWriteRegister:
      status = write_registers(request, from, data);
      break;
    case GvcpMessage::kWriteMemory:
      status = write_memory(request, from, data);
      break;
    case GvcpMessage::kPacketResend:
      take_resend(request);
      return;
    default:
      status = GevStatus::kNotImplemented;
      break;
  }
  if (request.wants_answer) answer(request, status, data, from);
}

GevStatus ControlChannel::read_registers(const Request& request, std::vector<std::uint8_t>& answer) {
  if (request.data.empty() || request.data.size() % 4 != 0) return GevStatus::kInvalidHeader;
  answer.resize(request.data.size());
  for (std::size_t i = 0; i < request.data.size(); i += 4) {
    const GevStatus status = bank_.read(get32(request.data.data() + i), std::span(answer).subspan(i, 4));
    if (status != GevStatus::kSuccess) return status;
  }
  return GevStatus::kSuccess;
}

GevStatus ControlChannel::read_memory(const Request& request, std::vector<std::uint8_t>& answer) {
  if (request.data.size() != 8) return GevStatus::kInvalidHeader;
  const std::size_t count = get16(request.data.data() + 6);
  if (count + kGvcpHeaderBytes + 4 > kMaxMessageBytes) return GevStatus::kInvalidHeader;
  answer.resize(4 + count);
  std::memcpy(answer.data(), request.data.data(), 4);
  return bank_.read(get32(request.data.data()), std::span(answer).subspan(4));
}

GevStatus ControlChannel::write_registers(const Request& request, const sockaddr_in& from,
                                          std::vector<std::uint8_t>& answer) {
  if (request.data.empty() || request.data.size() % 8 != 0) return GevStatus::kInvalidHeader;
  if (write_delay_ms_ > 0) announce_pending(request.id, from);
  GevStatus status = GevStatus::kSuccess;
  std::uint32_t done = 0;
  for (std::size_t i = 0; i < request.data.size() && status == GevStatus::kSuccess; i += 8) {
    status = write(get32(request.data.data() + i), request.data.subspan(i + 4, 4), from);
    if (status == GevStatus::kSuccess) ++done;
  }
  answer.resize(4);
  put32(answer.data(), done);
  return status;
}

GevStatus ControlChannel::write_memory(const Request& request, const sockaddr_in& from,
                                       std::vector<std::uint8_t>& answer) {
  if (request.data.size() < 8) return GevStatus::kInvalidHeader;
  if (write_delay_ms_ > 0) announce_pending(request.id, from);
  const std::span<const std::uint8_t> bytes = request.data.subspan(4);
  const GevStatus status = write(get32(request.data.data()), bytes, from);
  answer.resize(4);
  put32(answer.data(), status == GevStatus::kSuccess ? static_cast<std::uint32_t>(bytes.size()) : 0U);
  return status;
}

GevStatus ControlChannel::write(std::uint32_t at, std::span<const std::uint8_t> bytes, const sockaddr_in& from) {
  if (at == address::kControlPrivilege) return write_privilege(get32(bytes.data()), from);
  if (!is_controller(from)) return GevStatus::kAccessDenied;
  const GevStatus status = bank_.write(at, bytes);
  if (status == GevStatus::kSuccess && events_.written) events_.written(at, get32(bytes.data()));
  return status;
}

GevStatus ControlChannel::write_privilege(std::uint32_t value, const sockaddr_in& from) {
  if (controller_.ip != 0 && !is_controller(from)) return GevStatus::kAccessDenied;
  if ((value & 3U) == 0) {
    if (controller_.ip != 0) release_control();
    return GevStatus::kSuccess;
  }
  controller_ = {from.sin_addr.s_addr, from.sin_port, monotonic_us()};
  bank_.set(address::kControlPrivilege, value);
  return GevStatus::kSuccess;
}

void ControlChannel::take_resend(const Request& request) {
  if (request.data.size() < 12 || !events_.resend) return;
  const std::uint8_t* data = request.data.data();
  events_.resend(get16(data + 2), get32(data + 4) & 0x00ffffffU, get32(data + 8) & 0x00ffffffU);
}

void ControlChannel::announce_pending(std::uint16_t id, const sockaddr_in& from) {
  const int delay_ms = write_delay_ms_;
  std::array<std::uint8_t, 4> data{};
  put16(data.data() + 2, static_cast<std::uint32_t>(delay_ms));
  // The acknowledge of a message is numbered one above it, so the pending one is asked for by its number less one.
  answer({static_cast<GvcpMessage>(static_cast<std::uint16_t>(GvcpMessage::kPending) - 1), id, true, {}},
         GevStatus::kSuccess, data, from);
  std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
}

void ControlChannel::answer(const Request& request, GevStatus status, std::span<const std::uint8_t> data,
                            const sockaddr_in& from) {
  std::vector<std::uint8_t> bytes(kGvcpHeaderBytes);
  put16(bytes.data(), static_cast<std::uint16_t>(status));
  put16(bytes.data() + 2, static_cast<std::uint16_t>(request.message) + 1U);
  put16(bytes.data() + 4, static_cast<std::uint32_t>(status == GevStatus::kSuccess ? data.size() : 0));
  put16(bytes.data() + 6, request.id);
  if (status == GevStatus::kSuccess) bytes.insert(bytes.end(), data.begin(), data.end());
  ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&from), sizeof from);
}

}  // namespace beltpick::virtual_cell::gige
