// Tells the service manager how the process is: the datagram protocol behind NOTIFY_SOCKET (man 3 sd_notify), without
// its library. Does nothing where the variable is not set.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstdint>

#include "contract/registers.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::app {

class ServiceNotify {
 public:
  // Reads NOTIFY_SOCKET and WATCHDOG_USEC.
  ServiceNotify();
  ~ServiceNotify();
  ServiceNotify(const ServiceNotify&) = delete;
  ServiceNotify& operator=(const ServiceNotify&) = delete;

  // `state` as "READY=1", "STOPPING=1", "WATCHDOG=1"; never blocks.
  void tell(const char* state) const;

  // What `systemctl status` shows: the cell's state, and with `why` not kOk what it waits for or what is wrong. Sent
  // when it has changed.
  void tell_state(CellState state, ResultCode why);

  // Half the time after which the manager wants a sign of life; 0 when it wants none.
  [[nodiscard]] std::int64_t watchdog_us() const { return watchdog_us_; }

 private:
  int socket_ = -1;
  sockaddr_un to_{};
  socklen_t size_ = 0;
  std::int64_t watchdog_us_ = 0;
  std::array<char, 320> status_{};  // told last
};

}  // namespace beltpick::app
