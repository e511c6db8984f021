#include "emulator/rig.hpp"

#include <algorithm>
#include <cstdlib>

namespace emulator {

std::string firmware_file(Mcu mcu, const char* ending) {
  const char* folder = std::getenv("BELTPICK_FIRMWARE_DIR");
  return std::string(folder != nullptr ? folder : BELTPICK_FIRMWARE_DIR) +
         (mcu == Mcu::kAtmega2560 ? "/trigger_atmega2560" : "/trigger_atmega328p") + ending;
}

Rig::Rig(Mcu mcu) : chip(mcu, firmware_file(mcu, ".elf")) { connect(); }

Rig::Rig(Mcu mcu, const beltpick::boot::FlashImage& flash) : chip(mcu, flash) { connect(); }

void Rig::connect() {
  chip.on_edge = [this](const PinEdge& edge) { on_edge(edge); };
}

void Rig::on_edge(const PinEdge& edge) {
  edges.push_back(edge);
  if (edge.pin != Out::kCamera || !strobes) return;
  chip.at(edge.cycle + (edge.level ? strobe_rise_delay : strobe_fall_delay), [this, level = edge.level] {
    strobe_edges.push_back({Out::kCamera, level, chip.cycle()});
    chip.set_pin(In::kStrobe, level);
  });
}

void Rig::run_us(std::uint64_t us) {
  chip.run_us(us);
  std::vector<std::uint8_t> bytes = chip.received();
  bytes.resize(noise_back.pass(bytes.data(), bytes.size()));
  for (const std::uint8_t byte : bytes) {
    if (decoder_.push(byte) != protocol::FrameDecoder::Outcome::kMessage) continue;
    Message message;
    message.bytes.assign(decoder_.message(), decoder_.message() + decoder_.size());
    if (protocol::decode_header(message.bytes.data(), message.bytes.size(), message.header)) {
      messages.push_back(message);
    }
  }
}

void Rig::arm_and_start(const protocol::Arm& arm) {
  REQUIRE(request(protocol::Type::kArm, arm) == protocol::Refusal::kNone);
  edges.clear();
  REQUIRE(request(protocol::Type::kStart, protocol::Start{arm.arm_id}) == protocol::Refusal::kNone);
}

namespace {

struct Planned {
  std::uint64_t at_us;
  bool level;
};

std::vector<Planned> plan_of(Out pin, const protocol::Arm& arm) {
  std::vector<Planned> planned;
  std::uint64_t at_us = 0;
  for (std::uint8_t group = 0; group < arm.group_count; ++group) {
    const protocol::Group& timing = arm.groups[group];
    for (std::uint16_t frame = 0; frame < timing.frames; ++frame, at_us += timing.period_us) {
      const std::uint64_t rise_us = pin == Out::kProjector ? at_us : at_us + timing.settle_us;
      const std::uint64_t length_us = pin == Out::kProjector ? protocol::kAdvancePulse_us : timing.exposure_us;
      planned.push_back({rise_us, true});
      planned.push_back({rise_us + length_us, false});
    }
  }
  return planned;
}

}  // namespace

std::int64_t worst_deviation(const std::vector<PinEdge>& edges, const protocol::Arm& arm) {
  const auto first =
      std::find_if(edges.begin(), edges.end(), [](const PinEdge& e) { return e.pin == Out::kProjector; });
  std::int64_t worst = 0;
  for (const Out pin : {Out::kProjector, Out::kCamera}) {
    const std::vector<Planned> planned = plan_of(pin, arm);
    std::vector<PinEdge> seen;
    std::copy_if(edges.begin(), edges.end(), std::back_inserter(seen), [&](const PinEdge& e) { return e.pin == pin; });
    if (seen.size() != planned.size()) return -1;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].level != planned[i].level) return -1;
      const auto planned_cycle = static_cast<std::int64_t>(first->cycle + planned[i].at_us * kCyclesPerUs);
      worst = std::max(worst, std::abs(static_cast<std::int64_t>(seen[i].cycle) - planned_cycle));
    }
  }
  return worst;
}

}  // namespace emulator
