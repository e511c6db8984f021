// Rig: the emulated board with a camera that answers its pulses by strobes, and the host's end of its serial line.
#pragma once

#include <catch2/catch.hpp>
#include <optional>
#include <vector>

#include "emulator/chip.hpp"
#include "host/line_noise.hpp"
#include "protocol/messages.hpp"

namespace emulator {

namespace protocol = beltpick::protocol;

inline protocol::Arm sequence(std::uint16_t arm_id, std::uint16_t frames) {
  protocol::Arm arm;
  arm.arm_id = arm_id;
  arm.host_silence_ms = 60000;
  arm.strobe_tolerance_us = 200;
  arm.group_count = 1;
  arm.groups[0] = {frames, 1000, 8000, 12500, 4000};
  return arm;
}

// The firmware of the build, or of the folder that BELTPICK_FIRMWARE_DIR names: what another compiler made of it.
std::string firmware_file(Mcu mcu, const char* ending);

struct Message {
  protocol::Header header;
  std::vector<std::uint8_t> bytes;

  template <class Payload>
  Payload as() const {
    Payload payload;
    REQUIRE(protocol::decode_payload(bytes.data(), bytes.size(), payload));
    return payload;
  }
};

class Rig {
 public:
  // With the firmware of the build.
  explicit Rig(Mcu mcu);
  Rig(Mcu mcu, const beltpick::boot::FlashImage& flash);

  Chip chip;
  std::vector<PinEdge> edges;
  bool strobes = true;  // the strobe wire is whole
  std::uint64_t strobe_rise_delay = 20 * kCyclesPerUs;
  std::uint64_t strobe_fall_delay = 25 * kCyclesPerUs;
  std::vector<PinEdge> strobe_edges;        // as given to the board (the pin means nothing)
  std::vector<Message> messages;            // all that came
  beltpick::host::LineNoise noise_back{5};  // on what the firmware sends; none at first

  // Sends a request as the appliance does, a zero before it; its bytes on the wire.
  template <class Payload>
  std::size_t post(protocol::Type type, const Payload& payload) {
    std::uint8_t wire[1 + protocol::kMaxFrame] = {};
    const std::size_t size = 1 + protocol::encode(type, ++sequence_, payload, wire + 1, protocol::kMaxFrame);
    posted_.assign(wire, wire + size);
    chip.send(posted_);
    return size;
  }

  // Sends a request, again every 40 ms as the appliance does, and runs until its answer.
  template <class Payload>
  Message ask(protocol::Type type, const Payload& payload) {
    const std::size_t before = messages.size();
    post(type, payload);
    for (int quarters_of_ms = 1; quarters_of_ms < 800; ++quarters_of_ms) {
      if (quarters_of_ms % 160 == 0) chip.send(posted_);
      run_us(250);
      if (const Message* found = answer_since(before)) return *found;
    }
    FAIL("no reply");
    return {};
  }
  template <class Payload>
  protocol::Refusal request(protocol::Type type, const Payload& payload) {
    return ask(type, payload).template as<protocol::Reply>().refusal;
  }
  protocol::StatusReport status() {
    return ask(protocol::Type::kStatus, protocol::Empty()).as<protocol::StatusReport>();
  }
  void arm_and_start(const protocol::Arm& arm);

  void run_us(std::uint64_t us);
  template <class Event>
  std::vector<Event> events(protocol::Type type) const {
    std::vector<Event> found;
    for (const Message& message : messages) {
      if (message.header.type == type) found.push_back(message.as<Event>());
    }
    return found;
  }
  // Camera trigger, projector advance and BUSY are low.
  bool safe() const { return !chip.level(Out::kCamera) && !chip.level(Out::kProjector) && !chip.level(Out::kBusy); }

 private:
  const Message* answer_since(std::size_t before) const {
    for (std::size_t i = before; i < messages.size(); ++i) {
      const bool reply = static_cast<std::uint8_t>(messages[i].header.type) < 0xA0;
      if (reply && messages[i].header.sequence == sequence_) return &messages[i];
    }
    return nullptr;
  }
  void connect();
  void on_edge(const PinEdge& edge);

  protocol::FrameDecoder decoder_;
  std::uint8_t sequence_ = 0;
  std::vector<std::uint8_t> posted_;
};

// The largest distance of the edges from the armed sequence, in cycles, counted from the first advance; -1 when edges
// are missing, or there are others.
std::int64_t worst_deviation(const std::vector<PinEdge>& edges, const protocol::Arm& arm);

}  // namespace emulator
