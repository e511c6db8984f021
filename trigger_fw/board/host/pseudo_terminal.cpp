#include "host/pseudo_terminal.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace beltpick::host {

namespace {

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

void make_raw(int fd) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) fail("pseudo-terminal settings");
  ::cfmakeraw(&settings);
  if (::tcsetattr(fd, TCSANOW, &settings) != 0) fail("pseudo-terminal settings");
}

}  // namespace

PseudoTerminal::PseudoTerminal(const std::string& link) {
  master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  char name[128];
  if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
      ::ptsname_r(master_, name, sizeof name) != 0) {
    fail("pseudo-terminal");
  }
  tty_ = name;
  slave_ = ::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (slave_ < 0) fail("pseudo-terminal " + tty_);
  make_raw(slave_);
  if (!link.empty()) make_link(link);
}

void PseudoTerminal::make_link(const std::string& link) {
  char older[8];
  if (::readlink(link.c_str(), older, sizeof older) >= 0) ::unlink(link.c_str());
  if (::symlink(tty_.c_str(), link.c_str()) != 0) fail("link to the pseudo-terminal at " + link);
  link_ = link;
}

PseudoTerminal::~PseudoTerminal() {
  if (!link_.empty()) ::unlink(link_.c_str());
  if (slave_ >= 0) ::close(slave_);
  if (master_ >= 0) ::close(master_);
}

std::size_t PseudoTerminal::read(std::uint8_t* bytes, std::size_t capacity) {
  const ssize_t count = ::read(master_, bytes, capacity);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void PseudoTerminal::write(const std::uint8_t* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(master_, bytes, count);
    if (written <= 0) return;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

}  // namespace beltpick::host
