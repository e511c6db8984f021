// A LightCrafter 4500 behind a pseudo-terminal instead of a hidraw node: to a program that opens it by its path the
// same reports go out and in. Told on stdin what to do wrong:
//   refuse | silent | other-reply | fault | well | unplug | plug
// lightcrafter LINK: the path at which it can be opened.
#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/dlpc350/gadget.hpp"

using beltpick::test::Dlpc350Gadget;

namespace {

// Both ends, so that what is written while nobody has it open is not lost; raw.
struct Cable {
  int device = -1, host = -1;

  explicit Cable(const char* link) {
    device = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (device < 0 || ::grantpt(device) != 0 || ::unlockpt(device) != 0) std::exit(1);
    const std::string path = ::ptsname(device);
    host = ::open(path.c_str(), O_RDWR | O_NOCTTY);
    termios settings{};
    ::tcgetattr(host, &settings);
    ::cfmakeraw(&settings);
    ::tcsetattr(host, TCSANOW, &settings);
    ::unlink(link);
    if (::symlink(path.c_str(), link) != 0) std::exit(1);
  }
};

bool read_all(int fd, unsigned char* to, std::size_t count) {
  for (std::size_t got = 0; got < count;) {
    const ssize_t more = ::read(fd, to + got, count - got);
    if (more <= 0) return false;
    got += static_cast<std::size_t>(more);
  }
  return true;
}

void serve(int fd, Dlpc350Gadget& gadget) {
  unsigned char in[65];
  if (!read_all(fd, in, sizeof in)) return;
  Dlpc350Gadget::Bytes report{}, reply{};
  std::copy(in + 1, in + sizeof in, report.begin());
  if (gadget.take(report, reply) && ::write(fd, reply.data(), reply.size()) < 0) std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  Dlpc350Gadget gadget;
  Cable cable(argv[1]);
  std::string line;
  for (;;) {
    pollfd waiting[2]{{cable.device, POLLIN, 0}, {0, POLLIN, 0}};
    if (::poll(waiting, 2, -1) < 0) return 1;
    if ((waiting[0].revents & POLLIN) != 0) serve(cable.device, gadget);
    if (waiting[1].revents == 0) continue;
    char byte = 0;
    if (::read(0, &byte, 1) != 1) break;  // the test has ended
    if (byte != '\n') {
      line += byte;
      continue;
    }
    gadget.breaks = line == "refuse"        ? Dlpc350Gadget::Break::kRefuse
                    : line == "silent"      ? Dlpc350Gadget::Break::kSilent
                    : line == "other-reply" ? Dlpc350Gadget::Break::kOtherSequence
                                            : Dlpc350Gadget::Break::kNothing;
    gadget.hardware_bits = line == "fault" ? 0x81 : 0x01;
    if (line == "unplug") {
      ::close(cable.host);
      ::close(cable.device);
      ::unlink(argv[1]);
      cable.device = -1;
    }
    if (line == "plug") {
      gadget = {};
      cable = Cable(argv[1]);
    }
    line.clear();
  }
  ::unlink(argv[1]);
  return 0;
}
