// StreamChannel: sends frames as GVSP packets (leader, payload, trailer) by sendmmsg and keeps the last ones for
// resends.
#pragma once

#include <netinet/in.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "base/random.hpp"
#include "base/result.hpp"
#include "virtual_cell/gige/wire.hpp"

namespace beltpick::virtual_cell::gige {

// One frame on its way. Packet 0 is the leader, 1..payload_packets() the pixels, the last one the trailer.
struct StreamFrame {
  std::uint16_t block_id = 1;
  std::uint64_t stamp_us = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t payload_bytes = 0;  // a packet
  // Payload packets from this one on are never sent, nor resent: the sensor's readout broke off.
  std::uint32_t broken_from = UINT32_MAX;
  std::vector<std::uint8_t> pixels;

  [[nodiscard]] std::uint32_t payload_packets() const {
    return (static_cast<std::uint32_t>(pixels.size()) + payload_bytes - 1) / payload_bytes;
  }
};

struct StreamDestination {
  sockaddr_in to{};
  std::uint32_t packet_bytes = 0;  // as the packet size register counts: IP and UDP headers included
};

class StreamChannel {
 public:
  struct Counters {
    std::atomic<std::uint64_t> frames{0}, packets{0}, dropped{0}, resent{0}, refused{0};
  };

  // Binds to `ip` (host byte order). kServiceUnreachable where that fails.
  static Result<std::unique_ptr<StreamChannel>> open(std::uint32_t ip, double bytes_per_second);
  ~StreamChannel();
  StreamChannel(const StreamChannel&) = delete;
  StreamChannel& operator=(const StreamChannel&) = delete;

  // Sends a whole frame at the paced rate, each payload packet lost with probability `loss`.
  void send(std::shared_ptr<const StreamFrame> frame, const StreamDestination& destination, double loss);
  // Answers a resend request for packets [first, last] of a frame; what is no longer known is refused on the wire.
  void resend(std::uint16_t block_id, std::uint32_t first, std::uint32_t last, const StreamDestination& destination);
  // The packet by which a client probes what size gets through.
  void fire_test_packet(const StreamDestination& destination);

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  StreamChannel(int socket, std::uint16_t port, double bytes_per_second);

  std::size_t send_batch(const StreamFrame& frame, std::span<const std::uint32_t> packets, GevStatus status,
                         const StreamDestination& destination);
  void refuse(std::uint16_t block_id, std::uint32_t packet, const StreamDestination& destination);
  std::shared_ptr<const StreamFrame> recent(std::uint16_t block_id) const;

  static constexpr std::size_t kKeptFrames = 32;

  int socket_;
  std::uint16_t port_;
  double bytes_per_second_;
  Random random_{0x6b5e};
  mutable std::mutex mutex_;
  std::array<std::shared_ptr<const StreamFrame>, kKeptFrames> kept_;
  std::size_t next_kept_ = 0;
  Counters counters_;
};

}  // namespace beltpick::virtual_cell::gige
