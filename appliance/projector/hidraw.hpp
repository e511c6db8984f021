// A USB HID device by way of Linux hidraw: finding it by its ids, reports out and in. No library is needed.
#pragma once

#include <string>

#include "base/result.hpp"
#include "projector/dlpc350_report.hpp"

namespace beltpick::projector {

inline constexpr std::uint16_t kVendorTexasInstruments = 0x0451;
inline constexpr std::uint16_t kProductDlpc350 = 0x6401;

// The /dev/hidraw node of the first device with these ids, of its first USB interface; empty where there is none.
// `sysfs` is where the kernel lists the nodes.
std::string find_hidraw(std::uint16_t vendor, std::uint16_t product, const std::string& sysfs = "/sys/class/hidraw");

class HidChannel {
 public:
  HidChannel() = default;
  // Takes an open file descriptor over.
  explicit HidChannel(int fd) : fd_(fd) {}
  ~HidChannel() { close(); }
  HidChannel(HidChannel&& other) noexcept;
  HidChannel& operator=(HidChannel&& other) noexcept;

  // Error: kProjectorLost with the reason: not there, not permitted.
  static Result<HidChannel> open(const std::string& path);

  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  void close();

  // Error: kProjectorLost.
  Result<void> send(const Report& report);
  // Errors: kProjectorSilent after `timeout_ms`, kProjectorLost, kProjectorWrongReply for a report of another size.
  Result<Report> receive(int timeout_ms);
  // Throws away what has come unasked, as a reply that was given up.
  void drain();

 private:
  int fd_ = -1;
};

}  // namespace beltpick::projector
