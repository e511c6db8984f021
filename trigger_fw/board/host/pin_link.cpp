#include "host/pin_link.hpp"

#include <poll.h>
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

// Told apart from a message by its first byte: no kind is printable.
void PinLink::send_failure(const std::string& why) { ::send(fd_, why.data(), why.size(), MSG_NOSIGNAL); }

std::string PinLink::await_ready(int timeout_ms) {
  pollfd wait{fd_, POLLIN, 0};
  if (::poll(&wait, 1, timeout_ms) <= 0) return "it does not answer";
  char bytes[512] = {};
  const ssize_t size = ::recv(fd_, bytes, sizeof bytes, 0);
  if (size <= 0) return "it ended";
  if (bytes[0] == static_cast<char>(PinMessage::Kind::kReady)) return {};
  return {bytes, static_cast<std::size_t>(size)};
}

void PinLink::hang_up() { ::shutdown(fd_, SHUT_RDWR); }

}  // namespace beltpick::host
