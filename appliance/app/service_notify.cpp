#include "app/service_notify.hpp"

#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "app/controller.hpp"

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

void ServiceNotify::tell_state(CellState state, ResultCode why) {
  if (socket_ < 0) return;
  std::array<char, 320> status{};
  int length = std::snprintf(status.data(), status.size(), "STATUS=%s", state_name(state));
  const auto number = static_cast<unsigned>(why);
  if (const ResultCodeEntry* entry = find_result_code(why); entry != nullptr && why != ResultCode::kOk) {
    length += std::snprintf(status.data() + length, status.size() - static_cast<std::size_t>(length), ": %u %s: %s; %s",
                            number, entry->name.data(), entry->cause.data(), entry->remedy.data());
  } else if (why != ResultCode::kOk) {
    std::snprintf(status.data() + length, status.size() - static_cast<std::size_t>(length), ": %u %s", number,
                  result_code_name(why).data());
  }
  if (status == status_) return;
  status_ = status;
  tell(status_.data());
}

}  // namespace beltpick::app
