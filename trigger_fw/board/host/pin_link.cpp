#include "host/pin_link.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace beltpick::host {

PinLink::~PinLink() { ::close(fd_); }

bool PinLink::send(const PinMessage& message) {
  ssize_t sent = -1;
  do {
    sent = ::send(fd_, &message, sizeof message, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(sizeof message);
}

PinLink::Received PinLink::receive(PinMessage& message, bool wait) {
  ssize_t size = -1;
  do {
    size = ::recv(fd_, &message, sizeof message, wait ? 0 : MSG_DONTWAIT);
  } while (size < 0 && errno == EINTR);
  if (size == static_cast<ssize_t>(sizeof message)) return Received::kMessage;
  return size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK) ? Received::kNothing : Received::kGone;
}

void PinLink::hang_up() { ::shutdown(fd_, SHUT_RDWR); }

}  // namespace beltpick::host
