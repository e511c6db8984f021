#include "base/tty.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>

namespace beltpick {

std::expected<int, TtyError> open_tty(const char* path) {
  const int fd = ::open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return std::unexpected(TtyError{TtyFault::kCannotOpen, errno});
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    return std::unexpected(TtyError{TtyFault::kInUse, 0});
  }
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) {
    ::close(fd);
    return std::unexpected(TtyError{TtyFault::kNotATty, 0});
  }
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL | CRTSCTS);
  ::cfsetspeed(&settings, B500000);
  ::tcsetattr(fd, TCSANOW, &settings);
  ::tcflush(fd, TCIOFLUSH);
  return fd;
}

}  // namespace beltpick
