#include "projector/hidraw.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "contract/result_codes.hpp"

namespace beltpick::projector {

namespace {

std::unexpected<Error> lost(const char* doing) {
  return failure(ResultCode::kProjectorLost, "projector: lost while %s (%s); check its cable and power", doing,
                 std::strerror(errno));
}

// The `uevent` of a hidraw node's device: HID_ID=0003:00000451:00006401 (bus:vendor:product) and HID_PHYS=.../input0,
// where the number is that of the USB interface.
struct HidIds {
  unsigned bus = 0, vendor = 0, product = 0;
  bool first_interface = true;
};

HidIds read_ids(const std::string& uevent) {
  HidIds ids;
  std::ifstream file(uevent);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("HID_ID=")) {
      static_cast<void>(std::sscanf(line.c_str(), "HID_ID=%x:%x:%x", &ids.bus, &ids.vendor, &ids.product));
    }
    const std::size_t at = line.rfind("/input");
    if (line.starts_with("HID_PHYS=") && at != std::string::npos) ids.first_interface = line.substr(at) == "/input0";
  }
  return ids;
}

}  // namespace

std::string find_hidraw(std::uint16_t vendor, std::uint16_t product, const std::string& sysfs) {
  std::vector<std::string> nodes;
  DIR* folder = opendir(sysfs.c_str());
  if (folder == nullptr) return {};
  while (const dirent* entry = readdir(folder)) {
    if (std::strncmp(entry->d_name, "hidraw", 6) == 0) nodes.emplace_back(entry->d_name);
  }
  closedir(folder);
  std::sort(nodes.begin(), nodes.end());
  for (const std::string& node : nodes) {
    const HidIds ids = read_ids(sysfs + "/" + node + "/device/uevent");
    if (ids.vendor == vendor && ids.product == product && ids.first_interface) return "/dev/" + node;
  }
  return {};
}

HidChannel::HidChannel(HidChannel&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

HidChannel& HidChannel::operator=(HidChannel&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

void HidChannel::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Result<HidChannel> HidChannel::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd >= 0) return HidChannel(fd);
  if (errno == EACCES || errno == EPERM) {
    return failure(ResultCode::kProjectorLost,
                   "projector %s: may not be opened (%s); install deploy/udev/60-beltpick.rules and plug it in again",
                   path.c_str(), std::strerror(errno));
  }
  return failure(ResultCode::kProjectorLost, "projector %s: cannot be opened (%s); check its cable and power",
                 path.c_str(), std::strerror(errno));
}

Result<void> HidChannel::send(const Report& report) {
  // hidraw takes the report's number in front; 0 where reports are not numbered.
  std::array<std::uint8_t, kReportBytes + 1> bytes{};
  std::copy(report.begin(), report.end(), bytes.begin() + 1);
  const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
  if (written == static_cast<ssize_t>(bytes.size())) return {};
  if (written >= 0) errno = EIO;
  return lost("writing");
}

Result<Report> HidChannel::receive(int timeout_ms) {
  pollfd waiting{fd_, POLLIN, 0};
  const int ready = ::poll(&waiting, 1, timeout_ms);
  if (ready < 0) return lost("waiting for its reply");
  if (ready == 0) {
    return failure(ResultCode::kProjectorSilent, "projector: expected a reply within %d ms, found none", timeout_ms);
  }
  Report report{};
  const ssize_t got = ::read(fd_, report.data(), report.size());
  if (got == static_cast<ssize_t>(report.size())) return report;
  if (got > 0) {
    return failure(ResultCode::kProjectorWrongReply, "projector: expected a report of %zu bytes, found %zd",
                   kReportBytes, got);
  }
  if (got == 0) errno = ENODEV;
  return lost("reading its reply");
}

void HidChannel::drain() {
  Report report;
  while (::read(fd_, report.data(), report.size()) > 0) {
  }
}

}  // namespace beltpick::projector
