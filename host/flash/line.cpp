#include "flash/line.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cinttypes>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>

#include "base/tty.hpp"
#include "contract/result_codes.hpp"
#include "contract_io/file_io.hpp"

namespace beltpick::flash {

namespace {

// The process that holds the lock, by the kernel's list of locks; 0 where it cannot be told.
int lock_holder(const std::string& port) {
  struct stat status {};
  if (::stat(port.c_str(), &status) != 0) return 0;
  char wanted[64];
  std::snprintf(wanted, sizeof wanted, " %02x:%02x:%ju ", major(status.st_dev), minor(status.st_dev),
                static_cast<std::uintmax_t>(status.st_ino));
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    int pid = 0;
    if (line.find(wanted) != std::string::npos && std::sscanf(line.c_str(), "%*s %*s %*s %*s %d", &pid) == 1)
      return pid;
  }
  return 0;
}

std::string program_name(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/comm");
  std::string name;
  std::getline(file, name);
  return contract_io::one_line(name);
}

std::unexpected<Error> in_use(const std::string& port) {
  const int pid = lock_holder(port);
  const std::string name = program_name(pid);
  if (name == "beltpickd") {
    return failure(ResultCode::kDeviceInUse,
                   "%s: expected it to be free, found that beltpickd (process %d) holds it; stop the cell meanwhile: "
                   "sudo systemctl stop beltpickd",
                   port.c_str(), pid);
  }
  const std::string holder = name.empty() ? "another program" : name + " (process " + std::to_string(pid) + ")";
  return failure(ResultCode::kDeviceInUse, "%s: expected it to be free, found that %s holds it; end it", port.c_str(),
                 holder.c_str());
}

}  // namespace

Result<Line> Line::open(const std::string& port) {
  const std::string name = contract_io::one_line(port);
  const auto opened = open_tty(port.c_str());
  if (opened) return Line(*opened, port);
  switch (opened.error().fault) {
    case TtyFault::kInUse:
      return in_use(name);
    case TtyFault::kNotATty:
      return failure(ResultCode::kTriggerLost, "%s: expected the trigger box's tty, found something else; check --port",
                     name.c_str());
    default:
      return failure(ResultCode::kTriggerLost,
                     "%s: expected to open the trigger box's tty, found: %s; check its cable and --port, and that you "
                     "are in the group of the device",
                     name.c_str(), std::strerror(opened.error().error));
  }
}

Line::Line(int fd, std::string port) : fd_(fd), port_(std::move(port)) {}

Line::Line(Line&& other) noexcept : fd_(std::exchange(other.fd_, -1)), port_(std::move(other.port_)) {}

Line::~Line() {
  if (fd_ >= 0) ::close(fd_);
}

void Line::send(const std::uint8_t* bytes, std::size_t count) const {
  [[maybe_unused]] const ssize_t written = ::write(fd_, bytes, count);
}

std::optional<std::uint8_t> Line::receive(int timeout_ms) const {
  pollfd wait{fd_, POLLIN, 0};
  std::uint8_t byte = 0;
  if (::poll(&wait, 1, timeout_ms) <= 0 || ::read(fd_, &byte, 1) != 1) return std::nullopt;
  return byte;
}

// A line without modem signals takes no notice.
void Line::reset_board() const {
  const int dtr = TIOCM_DTR;
  ::ioctl(fd_, TIOCMBIC, &dtr);
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  ::ioctl(fd_, TIOCMBIS, &dtr);
}

void Line::forget() const { ::tcflush(fd_, TCIFLUSH); }

}  // namespace beltpick::flash
