// GvcpProbe: asks a GigE Vision camera whether it is there, by the protocol's discovery request sent to its address.
// Aravis' own ways to ask block for seconds on a dead camera; this one answers in time and allocates nothing.
#pragma once

#include <netinet/in.h>

#include <cstdint>

namespace beltpick::capture {

class GvcpProbe {
 public:
  // `address`: the camera's, in network byte order.
  explicit GvcpProbe(in_addr address);
  ~GvcpProbe();
  GvcpProbe(const GvcpProbe&) = delete;
  GvcpProbe& operator=(const GvcpProbe&) = delete;

  // Sends one request and waits for its answer. False when none came; true also when the system has no socket to ask
  // with.
  bool answers(int timeout_ms);

 private:
  int socket_ = -1;
  std::uint16_t request_id_ = 0;
};

}  // namespace beltpick::capture
