// GvcpProbe: asks a GigE Vision camera whether it is there, by the protocol's discovery request sent to its address.
// Aravis' own ways to ask block for seconds on a dead camera; this one answers in time and allocates nothing.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <span>

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

  // Who may change the camera's settings at present, as anybody may ask.
  struct Controller {
    bool there = false;
    in_addr address{};  // 0.0.0.0 where the camera does not tell
  };
  // Nothing when the camera did not answer.
  std::optional<Controller> controller(int timeout_ms);

 private:
  // Sends a command and waits for its acknowledge; the bytes received, 0 when none came in time.
  std::size_t ask(std::uint8_t command, std::span<const std::uint8_t> payload, std::span<std::uint8_t> answer,
                  int timeout_ms);
  std::optional<std::uint32_t> read_register(std::uint32_t address, int timeout_ms);

  int socket_ = -1;
  std::uint16_t request_id_ = 0;
};

}  // namespace beltpick::capture
