#include "live_switches.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "contract/result_codes.hpp"

namespace beltpick::cli {

using namespace virtual_cell;

namespace {
constexpr int kPoll_ms = 100;
constexpr std::size_t kLongestLine = 200;
}  // namespace

Result<std::unique_ptr<LiveSwitches>> LiveSwitches::open(const std::string& path, Plant& plant) {
  struct stat older {};
  if (::stat(path.c_str(), &older) == 0 && S_ISFIFO(older.st_mode)) ::unlink(path.c_str());
  const int fifo = ::mkfifo(path.c_str(), 0600) == 0 ? ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
  if (fifo < 0) {
    return failure(ResultCode::kFileNotWritten, "--switches %s: no FIFO can be made there (%s); name a free path",
                   path.c_str(), std::strerror(errno));
  }
  return std::unique_ptr<LiveSwitches>(new LiveSwitches(path, fifo, plant));
}

LiveSwitches::LiveSwitches(std::string path, int fifo, Plant& plant)
    : path_(std::move(path)), fifo_(fifo), plant_(plant) {
  thread_ = std::thread([this] { run(); });
}

LiveSwitches::~LiveSwitches() {
  stopping_ = true;
  thread_.join();
  ::close(fifo_);
  ::unlink(path_.c_str());
}

void LiveSwitches::run() {
  std::string line;
  pollfd wait{fifo_, POLLIN, 0};
  while (!stopping_) {
    if (::poll(&wait, 1, kPoll_ms) <= 0) continue;
    char byte = 0;
    while (::read(fifo_, &byte, 1) == 1) {
      if (byte != '\n' && line.size() < kLongestLine) {
        line += byte;
        continue;
      }
      obey(line);
      line.clear();
    }
  }
}

void LiveSwitches::obey(std::string_view line) {
  if (line.empty()) return;
  const CellFaultEntry* entry = find_fault(line);
  if (line == "mend") {
    plant_.set_emergency_stop_line(false);
    plant_.mend_devices();
  } else if (entry != nullptr && entry->fault == CellFault::kEmergencyStop) {
    plant_.set_emergency_stop_line(true);
  } else if (entry != nullptr && entry->by != FaultBy::kPlc) {
    plant_.break_device(entry->fault);
  } else {
    std::fprintf(stderr, "beltpick simulate: --switches: expected mend or a fault of a device, found '%.*s'\n",
                 static_cast<int>(line.size()), line.data());
    return;
  }
  std::fprintf(stderr, "virtual cell: switch %.*s\n", static_cast<int>(line.size()), line.data());
}

}  // namespace beltpick::cli
