#include "service/listen_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "contract/result_codes.hpp"

namespace beltpick::service {
namespace {

constexpr int kBacklog = 32;

union SocketAddress {
  sockaddr any;
  sockaddr_in v4;
  sockaddr_in6 v6;
};

bool parse(const std::string& text, std::uint16_t port, SocketAddress& address) {
  address = {};
  if (inet_pton(AF_INET, text.c_str(), &address.v4.sin_addr) == 1) {
    address.v4.sin_family = AF_INET;
    address.v4.sin_port = htons(port);
    return true;
  }
  if (inet_pton(AF_INET6, text.c_str(), &address.v6.sin6_addr) != 1) return false;
  address.v6.sin6_family = AF_INET6;
  address.v6.sin6_port = htons(port);
  return true;
}

}  // namespace

Result<Descriptor> listen_on(const std::string& address, std::uint16_t port) {
  SocketAddress at{};
  if (!parse(address, port, at)) {
    return failure(ResultCode::kValueOutOfRange,
                   "service.address: expected an IPv4 or IPv6 address in numbers, found \"%.60s\"; correct it",
                   address.c_str());
  }
  Descriptor listener(socket(at.any.sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1, off = 0;
  const socklen_t bytes = at.any.sa_family == AF_INET ? sizeof at.v4 : sizeof at.v6;
  (void)setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (at.any.sa_family == AF_INET6) (void)setsockopt(listener.get(), IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  if (listener.open() && bind(listener.get(), &at.any, bytes) == 0 && listen(listener.get(), kBacklog) == 0) {
    return listener;
  }
  return failure(ResultCode::kUsage,
                 "service.address %.60s port %u: expected to listen there, found: %s; is another beltpickd running?",
                 address.c_str(), port, std::strerror(errno));
}

std::string url_host(const std::string& address) {
  return address.find(':') == std::string::npos ? address : '[' + address + ']';
}

std::uint16_t port_of(const Descriptor& socket) {
  SocketAddress at{};
  socklen_t bytes = sizeof at;
  if (getsockname(socket.get(), &at.any, &bytes) != 0) return 0;
  return ntohs(at.any.sa_family == AF_INET ? at.v4.sin_port : at.v6.sin6_port);
}

}  // namespace beltpick::service
