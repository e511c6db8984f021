// Who answers on the trigger box's line: its firmware, of any version of the protocol, or the boot loader.
#pragma once

#include <cstdint>
#include <optional>

#include "base/result.hpp"
#include "boot/layout.hpp"
#include "flash/line.hpp"
#include "protocol/messages.hpp"

namespace beltpick::flash {

struct Peer {
  const boot::ChipLayout* chip = nullptr;  // null where it is none of ours
  bool is_loader = false;
  // Of a firmware. Of another version of the protocol only board and version are known.
  std::uint8_t protocol_version = protocol::kVersion;
  protocol::Identity identity;

  [[nodiscard]] bool speaks_our_protocol() const { return protocol_version == protocol::kVersion; }
};

// The firmware, if it answers within `timeout_ms`.
std::optional<Peer> find_firmware(const Line& line, int timeout_ms);
// The boot loader, likewise. A firmware takes no notice of the question.
std::optional<Peer> find_loader(const Line& line, int timeout_ms);
// Either. A board that resets when its line is opened is given the time to start.
std::optional<Peer> find_peer(const Line& line, int timeout_ms);

// Asks the firmware for its boot loader. The firmware's answer; nothing when there is none.
std::optional<protocol::Refusal> ask_for_loader(const Line& line, const Peer& firmware);

}  // namespace beltpick::flash
