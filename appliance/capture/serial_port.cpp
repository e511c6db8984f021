#include "capture/serial_port.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "contract/result_codes.hpp"

namespace beltpick::capture {

Result<int> open_serial(const char* path) {
  const int fd = ::open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    return failure(ResultCode::kTriggerLost,
                   "trigger %s: cannot be opened (%s); check its cable and the configured tty", path,
                   std::strerror(errno));
  }
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    return failure(ResultCode::kTriggerLost, "trigger %s: another program uses it; end that program", path);
  }
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) {
    ::close(fd);
    return failure(ResultCode::kTriggerLost,
                   "trigger %s: expected a tty, found something else; check the configured tty", path);
  }
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL | CRTSCTS);
  ::cfsetspeed(&settings, B500000);
  ::tcsetattr(fd, TCSANOW, &settings);
  ::tcflush(fd, TCIOFLUSH);
  return fd;
}

}  // namespace beltpick::capture
