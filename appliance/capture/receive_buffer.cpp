#include "capture/receive_buffer.hpp"

#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>

namespace beltpick::capture {

namespace {

bool is_udp_at(int fd, std::uint16_t port) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  int type = 0;
  socklen_t type_size = sizeof type;
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 && address.sin_family == AF_INET &&
         ntohs(address.sin_port) == port && ::getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) == 0 &&
         type == SOCK_DGRAM;
}

}  // namespace

// Aravis keeps the socket to itself, so it is looked for by its port.
void enlarge_receive_buffer(std::uint16_t port, int bytes) {
  constexpr int kMostDescriptors = 4096;
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  const int end = static_cast<int>(std::min<rlim_t>(limit.rlim_cur, kMostDescriptors));
  for (int fd = 3; fd < end; ++fd) {
    if (!is_udp_at(fd, port)) continue;
    if (::setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0) {
      ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    }
    return;
  }
}

}  // namespace beltpick::capture
