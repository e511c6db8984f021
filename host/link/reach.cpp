#include "link/reach.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "contract/result_codes.hpp"

namespace beltpick::link {
namespace {

struct FreeAddresses {
  void operator()(addrinfo* list) const { freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Result<Addresses> look_up(const Address& address) {
  addrinfo wish{};
  wish.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const int status = getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &wish, &list);
  if (status == 0) return Addresses(list);
  return failure(ResultCode::kServiceUnreachable, "%s: expected a name that resolves, found: %s", address.host.c_str(),
                 status == EAI_SYSTEM ? std::strerror(errno) : gai_strerror(status));
}

std::string numeric(const addrinfo& address) {
  char host[NI_MAXHOST]{};
  getnameinfo(address.ai_addr, address.ai_addrlen, host, sizeof host, nullptr, 0, NI_NUMERICHOST);
  return host;
}

// 0, or errno of the attempt.
int connect_to(const addrinfo& address, int timeout_ms) {
  const int socket = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) return errno;
  int error = connect(socket, address.ai_addr, address.ai_addrlen) == 0 ? 0 : errno;
  if (error == EINPROGRESS) {
    pollfd wait{socket, POLLOUT, 0};
    socklen_t size = sizeof error;
    error = ETIMEDOUT;
    if (poll(&wait, 1, timeout_ms) == 1) getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size);
  }
  close(socket);
  return error;
}

}  // namespace

Result<std::vector<std::string>> resolve(const Address& address) {
  const auto list = look_up(address);
  if (!list) return std::unexpected(list.error());
  std::vector<std::string> found;
  for (const addrinfo* at = list->get(); at != nullptr; at = at->ai_next) {
    const std::string text = numeric(*at);
    if (std::find(found.begin(), found.end(), text) == found.end()) found.push_back(text);
  }
  return found;
}

Result<std::string> knock(const Address& address, int timeout_ms) {
  const auto list = look_up(address);
  if (!list) return std::unexpected(list.error());
  int error = ENOENT;
  for (const addrinfo* at = list->get(); at != nullptr; at = at->ai_next) {
    error = connect_to(*at, timeout_ms);
    if (error == 0) return numeric(*at);
  }
  return failure(ResultCode::kServiceUnreachable, "%s: expected an open port, found: %s", address.text().c_str(),
                 std::strerror(error));
}

}  // namespace beltpick::link
