// The network's part of machine_facts.hpp.
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

#include "contract/registers.hpp"
#include "service/folder.hpp"
#include "service/machine_facts.hpp"

namespace beltpick::service {

namespace {

constexpr std::uint16_t kGvcpPort = 3956;
constexpr int kAnswer_ms = 500;
constexpr int kHeartbeat_ms = 250;  // two beats and a half

struct Endpoint {
  sockaddr_storage address{};
  socklen_t size = 0;
};

std::optional<Endpoint> endpoint(const std::string& address, int port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return std::nullopt;
  Endpoint to;
  std::memcpy(&to.address, found->ai_addr, found->ai_addrlen);
  to.size = found->ai_addrlen;
  ::freeaddrinfo(found);
  return to;
}

const sockaddr* generic(const sockaddr_storage& address) { return reinterpret_cast<const sockaddr*>(&address); }

bool ready(int fd, short events) {
  pollfd wait{fd, events, 0};
  return ::poll(&wait, 1, kAnswer_ms) > 0 && (wait.revents & events) != 0;
}

// A connection that was there within the time, or a closed descriptor.
Descriptor connect_to(const std::string& address, int port) {
  const auto to = endpoint(address == "0.0.0.0" ? "127.0.0.1" : address, port);
  if (!to) return {};
  Descriptor socket(::socket(to->address.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const bool there = ::connect(socket.get(), generic(to->address), to->size) == 0 ||
                     (errno == EINPROGRESS && ready(socket.get(), POLLOUT));
  return there ? std::move(socket) : Descriptor();
}

constexpr std::size_t kAskedRegisters = 7;
using Registers = std::array<std::uint16_t, kAskedRegisters>;

// Modbus function 4: the first input registers.
std::optional<Registers> read_inputs(int fd) {
  constexpr std::array<std::uint8_t, 12> kRequest{0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, kAskedRegisters};
  constexpr std::size_t kHead = 9;
  if (::send(fd, kRequest.data(), kRequest.size(), MSG_NOSIGNAL) != ssize_t{kRequest.size()}) return std::nullopt;
  std::array<std::uint8_t, kHead + 2 * kAskedRegisters> answer{};
  std::size_t have = 0;
  while (have < answer.size()) {
    if (!ready(fd, POLLIN)) return std::nullopt;
    const ssize_t got = ::recv(fd, answer.data() + have, answer.size() - have, 0);
    if (got <= 0) return std::nullopt;
    have += static_cast<std::size_t>(got);
    if (have >= kHead && (answer[7] != 4 || answer[8] != 2 * kAskedRegisters)) return std::nullopt;
  }
  Registers registers{};
  for (std::size_t i = 0; i < registers.size(); ++i) {
    registers[i] = static_cast<std::uint16_t>(answer[kHead + 2 * i] << 8U | answer[kHead + 2 * i + 1]);
  }
  return registers;
}

PortState port_state(int error) {
  if (error == EADDRINUSE) return PortState::kTaken;
  return error == EACCES || error == EPERM ? PortState::kForbidden : PortState::kNoSuchAddress;
}

}  // namespace

SocketBufferFound find_socket_buffer(std::int64_t wanted_bytes, std::int64_t frame_bytes) {
  SocketBufferFound found{0, wanted_bytes, frame_bytes};
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const int wanted = static_cast<int>(wanted_bytes);
  if (::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0) {
    ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  }
  int granted = 0;
  socklen_t size = sizeof granted;
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size) == 0) {
    found.granted_bytes = granted / 2;  // Linux doubles it, for its own books
  }
  return found;
}

InterfaceFound find_interface(const std::string& address) {
  const auto camera = endpoint(address, kGvcpPort);
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in own{};
  socklen_t size = sizeof own;
  if (!camera || ::connect(socket.get(), generic(camera->address), camera->size) != 0 ||
      ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    return {};
  }
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> list(first, &::freeifaddrs);
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    const auto* of = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
    // The whole of 127/8 is the loopback's.
    const bool loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0 && ntohl(own.sin_addr.s_addr) >> 24U == 127U;
    if (of->sin_addr.s_addr != own.sin_addr.s_addr && !loopback) continue;
    ifreq request{};
    std::strncpy(request.ifr_name, entry->ifa_name, sizeof request.ifr_name - 1);
    if (::ioctl(socket.get(), SIOCGIFMTU, &request) != 0) return {};
    return {entry->ifa_name, request.ifr_mtu};
  }
  return {};
}

PortFound find_port(const std::string& address, int port) {
  PortFound found{PortState::kNoSuchAddress, address, port, "", false};
  const auto at = endpoint(address, port);
  if (!at) {
    found.problem = "no IP address";
    return found;
  }
  const Descriptor socket(::socket(at->address.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(socket.get(), generic(at->address), at->size) == 0 && ::listen(socket.get(), 1) == 0) {
    found.state = PortState::kFree;
  } else {
    found.state = port_state(errno);
    found.problem = std::strerror(errno);
  }
  return found;
}

std::optional<DaemonWord> ask_daemon(const std::string& address, int port) {
  const Descriptor socket = connect_to(address, port);
  if (!socket.open()) return std::nullopt;
  const auto before = read_inputs(socket.get());
  if (!before) return std::nullopt;
  std::this_thread::sleep_for(std::chrono::milliseconds(kHeartbeat_ms));
  const auto after = read_inputs(socket.get());
  // Another Modbus server has no heart that beats ten times a second just there.
  const std::size_t heartbeat = register_address("heartbeat");
  const std::size_t state = register_address("state");
  if (!after || (*after)[heartbeat] == (*before)[heartbeat]) return std::nullopt;
  if ((*after)[state] > static_cast<std::uint16_t>(CellState::kFault)) return std::nullopt;
  return DaemonWord{(*after)[state], (*after)[register_address("fault_code")], (*after)[register_address("last_code")]};
}

}  // namespace beltpick::service
