#include "flash/peer.hpp"

#include <chrono>
#include <thread>

#include "base/clock.hpp"
#include "boot/seal.hpp"
#include "boot/stk500.hpp"

namespace beltpick::flash {

using protocol::Type;

namespace {

constexpr int kRepeatMs = 250;
constexpr std::chrono::milliseconds kLoaderForgets(300);  // a request that broke off

struct Message {
  protocol::Header header;
  const std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
};

// Sends a request without payload, in the given version of the protocol. The zero ends whatever stands before it.
void post(const Line& line, Type type, std::uint8_t version) {
  const std::uint8_t message[protocol::kHeaderBytes] = {version, static_cast<std::uint8_t>(type), 1};
  std::uint8_t frame[16] = {0};
  const std::size_t size = protocol::encode_frame(message, sizeof message, frame + 1, sizeof frame - 1);
  line.send(frame, size + 1);
}

// Hands every message that comes within `timeout_ms` to `take`, until it returns true.
template <class Take>
bool listen(const Line& line, int timeout_ms, Take take) {
  protocol::FrameDecoder decoder;
  const Stopwatch watch;
  while (true) {
    const int left_ms = timeout_ms - static_cast<int>(watch.elapsed_ms());
    const auto byte = left_ms > 0 ? line.receive(left_ms) : std::nullopt;
    if (!byte) return false;
    if (decoder.push(*byte) != protocol::FrameDecoder::Outcome::kMessage) continue;
    Message message{{}, decoder.message(), decoder.size()};
    if (protocol::decode_header(message.bytes, message.size, message.header) && take(message)) return true;
  }
}

// Board and version stand first in every version of the protocol.
bool read_identity(const Message& message, protocol::Identity& identity) {
  if (message.header.version == protocol::kVersion) {
    return protocol::decode_payload(message.bytes, message.size, identity);
  }
  if (message.size < protocol::kHeaderBytes + 4) return false;
  protocol::Reader reader(message.bytes + protocol::kHeaderBytes, 4);
  reader.enumerator(identity.board);
  reader.u8(identity.firmware_major);
  reader.u8(identity.firmware_minor);
  reader.u8(identity.firmware_patch);
  return true;
}

// Reads `count` bytes of the loader's answer, which follow each other at once.
bool read_answer(const Line& line, std::uint8_t* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto byte = line.receive(kRepeatMs);
    if (!byte) return false;
    bytes[i] = *byte;
  }
  return true;
}

const boot::ChipLayout* ask_signature(const Line& line) {
  const std::uint8_t request[] = {boot::stk500::kReadSignature, boot::stk500::kEnd};
  line.send(request, sizeof request);
  std::uint8_t answer[5];
  if (!read_answer(line, answer, sizeof answer) || answer[0] != boot::stk500::kInSync) return nullptr;
  return boot::find_chip({answer[1], answer[2], answer[3]});
}

}  // namespace

std::optional<Peer> find_firmware(const Line& line, int timeout_ms) {
  Peer peer;
  const Stopwatch watch;
  while (watch.elapsed_ms() < timeout_ms) {
    post(line, Type::kIdentify, peer.protocol_version);
    const std::uint8_t spoken = peer.protocol_version;
    bool identified = false;
    const auto take = [&](const Message& message) {
      peer.protocol_version = message.header.version;
      identified = message.header.type == Type::kIdentity && read_identity(message, peer.identity);
      return identified || peer.protocol_version != spoken;
    };
    listen(line, kRepeatMs, take);
    if (!identified) continue;
    peer.chip = boot::find_chip(peer.identity.board);
    return peer;
  }
  return std::nullopt;
}

std::optional<Peer> find_loader(const Line& line, int timeout_ms) {
  const Stopwatch watch;
  while (watch.elapsed_ms() < timeout_ms) {
    std::this_thread::sleep_for(kLoaderForgets);
    line.forget();
    const std::uint8_t request[] = {boot::stk500::kGetSync, boot::stk500::kEnd};
    line.send(request, sizeof request);
    std::uint8_t answer[2];
    const bool in_step = read_answer(line, answer, sizeof answer) && answer[0] == boot::stk500::kInSync &&
                         answer[1] == boot::stk500::kOk;
    Peer peer;
    peer.is_loader = true;
    peer.chip = in_step ? ask_signature(line) : nullptr;
    if (peer.chip != nullptr) return peer;
  }
  return std::nullopt;
}

std::optional<Peer> find_peer(const Line& line, int timeout_ms) {
  const Stopwatch watch;
  while (watch.elapsed_ms() < timeout_ms) {
    if (auto firmware = find_firmware(line, 2 * kRepeatMs)) return firmware;
    if (auto loader = find_loader(line, kRepeatMs)) return loader;
  }
  return std::nullopt;
}

std::optional<protocol::Refusal> ask_for_loader(const Line& line, const Peer& firmware) {
  std::optional<protocol::Refusal> refusal;
  for (int attempt = 0; attempt < 4 && !refusal; ++attempt) {
    post(line, Type::kEnterLoader, firmware.protocol_version);
    listen(line, kRepeatMs, [&](const Message& message) {
      protocol::Reply reply;
      const bool ours = message.header.type == Type::kReply &&
                        protocol::decode_payload(message.bytes, message.size, reply) &&
                        reply.request == Type::kEnterLoader;
      if (ours) refusal = reply.refusal;
      return ours;
    });
  }
  return refusal;
}

}  // namespace beltpick::flash
