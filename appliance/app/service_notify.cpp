#include "app/service_notify.hpp"

#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace beltpick::app {

ServiceNotify::ServiceNotify() {
  const char* path = std::getenv("NOTIFY_SOCKET");
  if (path == nullptr || (path[0] != '/' && path[0] != '@')) return;
  const std::size_t length = std::strlen(path);
  if (length >= sizeof to_.sun_path) return;
  to_.sun_family = AF_UNIX;
  std::memcpy(to_.sun_path, path, length);
  if (path[0] == '@') to_.sun_path[0] = '\0';  // an abstract name
  size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
  socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (const char* usec = std::getenv("WATCHDOG_USEC")) watchdog_us_ = std::strtoll(usec, nullptr, 10) / 2;
}

ServiceNotify::~ServiceNotify() {
  if (socket_ >= 0) close(socket_);
}

void ServiceNotify::tell(const char* state) const {
  if (socket_ < 0) return;
  // A manager that does not listen is not our fault; it will restart us if it wants to.
  (void)!sendto(socket_, state, std::strlen(state), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to_), size_);
}

}  // namespace beltpick::app
