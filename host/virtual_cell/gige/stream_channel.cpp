#include "virtual_cell/gige/stream_channel.hpp"

#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "contract/result_codes.hpp"
#include "virtual_cell/gige/registers.hpp"

namespace beltpick::virtual_cell::gige {
namespace {

constexpr std::size_t kBatch = 32;             // packets handed to the kernel at once, at most
constexpr std::uint32_t kBatchBytes = 32'000;  // what a receiver's socket buffer of ordinary size takes easily
constexpr std::size_t kLeaderBytes = 36;
constexpr std::size_t kTrailerBytes = 8;
constexpr std::uint16_t kImagePayload = 1;

// A packet's header and the leader or trailer behind it; pixels are sent from where they lie.
struct PacketHead {
  std::array<std::uint8_t, kGvspHeaderBytes + kLeaderBytes> bytes{};
  std::size_t size = kGvspHeaderBytes;
};

void put_header(PacketHead& head, std::uint16_t block_id, std::uint32_t packet, GvspContent content, GevStatus status) {
  put16(head.bytes.data(), static_cast<std::uint16_t>(status));
  put16(head.bytes.data() + 2, block_id);
  put32(head.bytes.data() + 4, (static_cast<std::uint32_t>(content) << 24U) | packet);
}

void put_leader(PacketHead& head, const StreamFrame& frame) {
  std::uint8_t* at = head.bytes.data() + kGvspHeaderBytes;
  put16(at + 2, kImagePayload);
  put32(at + 4, static_cast<std::uint32_t>(frame.stamp_us >> 32U));
  put32(at + 8, static_cast<std::uint32_t>(frame.stamp_us));
  put32(at + 12, kMono8);
  put32(at + 16, frame.width);
  put32(at + 20, frame.height);
  head.size = kGvspHeaderBytes + kLeaderBytes;
}

void put_trailer(PacketHead& head, const StreamFrame& frame) {
  std::uint8_t* at = head.bytes.data() + kGvspHeaderBytes;
  put16(at + 2, kImagePayload);
  put32(at + 4, frame.height);
  head.size = kGvspHeaderBytes + kTrailerBytes;
}

// Fills head and pixel range of one packet; the number of iovecs used.
std::size_t make_packet(const StreamFrame& frame, std::uint32_t packet, GevStatus status, PacketHead& head,
                        std::array<iovec, 2>& parts) {
  const std::uint32_t payload_packets = frame.payload_packets();
  GvspContent content = GvspContent::kPayload;
  if (packet == 0) content = GvspContent::kLeader;
  if (packet > payload_packets) content = GvspContent::kTrailer;
  put_header(head, frame.block_id, packet, content, status);
  if (content == GvspContent::kLeader) put_leader(head, frame);
  if (content == GvspContent::kTrailer) put_trailer(head, frame);
  parts[0] = {head.bytes.data(), head.size};
  if (content != GvspContent::kPayload) return 1;
  const std::size_t from = static_cast<std::size_t>(packet - 1) * frame.payload_bytes;
  const std::size_t size = std::min<std::size_t>(frame.payload_bytes, frame.pixels.size() - from);
  parts[1] = {const_cast<std::uint8_t*>(frame.pixels.data() + from), size};  // iovec has no const; sendmsg only reads
  return 2;
}

}  // namespace

Result<std::unique_ptr<StreamChannel>> StreamChannel::open(std::uint32_t ip, double bytes_per_second) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(ip);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (fd < 0 || ::bind(fd, generic, size) != 0 || ::getsockname(fd, generic, &size) != 0) {
    const int reason = errno;
    if (fd >= 0) ::close(fd);
    return failure(ResultCode::kServiceUnreachable, "virtual camera: cannot open its stream socket: %s",
                   std::strerror(reason));
  }
  return std::unique_ptr<StreamChannel>(new StreamChannel(fd, ntohs(address.sin_port), bytes_per_second));
}

StreamChannel::StreamChannel(int socket, std::uint16_t port, double bytes_per_second)
    : socket_(socket), port_(port), bytes_per_second_(bytes_per_second) {}

StreamChannel::~StreamChannel() { ::close(socket_); }

void StreamChannel::send(std::shared_ptr<const StreamFrame> frame, const StreamDestination& destination, double loss) {
  {
    const std::scoped_lock lock(mutex_);
    kept_[next_kept_++ % kKeptFrames] = frame;
  }
  const std::uint32_t last = frame->payload_packets() + 1;
  std::array<std::uint32_t, kBatch> batch{};
  const std::size_t batch_packets = std::clamp<std::size_t>(kBatchBytes / frame->payload_bytes, 1, kBatch);
  const auto start = std::chrono::steady_clock::now();
  double sent_bytes = 0.0;
  for (std::uint32_t packet = 0; packet <= last;) {
    std::size_t count = 0;
    for (; packet <= last && count < batch_packets; ++packet) {
      const bool payload = packet > 0 && packet < last;
      if (payload && packet >= frame->broken_from) continue;
      if (payload && random_.uniform() < loss) {
        ++counters_.dropped;
        continue;
      }
      batch[count++] = packet;
    }
    sent_bytes += static_cast<double>(send_batch(*frame, {batch.data(), count}, GevStatus::kSuccess, destination));
    std::this_thread::sleep_until(start +
                                  std::chrono::microseconds(std::llround(sent_bytes / bytes_per_second_ * 1e6)));
  }
  ++counters_.frames;
}

std::size_t StreamChannel::send_batch(const StreamFrame& frame, std::span<const std::uint32_t> packets,
                                      GevStatus status, const StreamDestination& destination) {
  std::array<PacketHead, kBatch> heads;
  std::array<std::array<iovec, 2>, kBatch> parts;
  std::array<mmsghdr, kBatch> messages{};
  sockaddr_in to = destination.to;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    messages[i].msg_hdr.msg_iovlen = make_packet(frame, packets[i], status, heads[i], parts[i]);
    messages[i].msg_hdr.msg_iov = parts[i].data();
    messages[i].msg_hdr.msg_name = &to;
    messages[i].msg_hdr.msg_namelen = sizeof to;
    for (std::size_t k = 0; k < messages[i].msg_hdr.msg_iovlen; ++k) bytes += parts[i][k].iov_len;
  }
  for (std::size_t done = 0; done < packets.size();) {
    const int sent = ::sendmmsg(socket_, messages.data() + done, static_cast<unsigned>(packets.size() - done), 0);
    if (sent > 0) {
      done += static_cast<std::size_t>(sent);
    } else if (errno != EINTR) {
      ++done;  // nobody listens (ECONNREFUSED) or no room: the packet is lost, as on a wire
    }
  }
  counters_.packets += packets.size();
  return bytes;
}

void StreamChannel::resend(std::uint16_t block_id, std::uint32_t first, std::uint32_t last,
                           const StreamDestination& destination) {
  const auto frame = recent(block_id);
  if (frame == nullptr) {
    refuse(block_id, first, destination);
    return;
  }
  last = std::min(last, frame->payload_packets() + 1);
  for (std::uint32_t packet = first; packet <= last; ++packet) {
    if (packet >= frame->broken_from && packet <= frame->payload_packets()) {
      refuse(block_id, packet, destination);
      continue;
    }
    send_batch(*frame, {&packet, 1}, GevStatus::kPacketResent, destination);
    ++counters_.resent;
  }
}

void StreamChannel::refuse(std::uint16_t block_id, std::uint32_t packet, const StreamDestination& destination) {
  PacketHead head;
  put_header(head, block_id, packet, GvspContent::kPayload, GevStatus::kPacketUnavailable);
  ::sendto(socket_, head.bytes.data(), kGvspHeaderBytes, 0, reinterpret_cast<const sockaddr*>(&destination.to),
           sizeof destination.to);
  ++counters_.refused;
}

void StreamChannel::fire_test_packet(const StreamDestination& destination) {
  if (destination.packet_bytes <= kIpUdpHeaderBytes) return;
  const std::vector<std::uint8_t> bytes(destination.packet_bytes - kIpUdpHeaderBytes);
  ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&destination.to),
           sizeof destination.to);
}

std::shared_ptr<const StreamFrame> StreamChannel::recent(std::uint16_t block_id) const {
  const std::scoped_lock lock(mutex_);
  for (const auto& frame : kept_) {
    if (frame != nullptr && frame->block_id == block_id) return frame;
  }
  return nullptr;
}

}  // namespace beltpick::virtual_cell::gige
