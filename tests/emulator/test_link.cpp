// The appliance's own TriggerLink talks to the real firmware over a pseudo-terminal, as it would over a cable.
#include <chrono>
#include <functional>

#include "base/clock.hpp"
#include "capture/trigger_link.hpp"
#include "contract/result_codes.hpp"
#include "emulator/live_line.hpp"
#include "emulator/rig.hpp"

using namespace beltpick;
using emulator::In;
using emulator::LiveLine;
using emulator::Mcu;
using emulator::Out;
using emulator::Rig;
using protocol::Type;

namespace {

// Generous: only a failing test waits that long.
bool eventually(const std::function<bool()>& condition) {
  const std::int64_t until_us = monotonic_us() + 20'000'000;
  while (monotonic_us() < until_us) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return condition();
}

// Collects the events up to DONE or FAULT; true when one came.
struct Events {
  std::vector<protocol::FrameEvent> frames;
  std::optional<protocol::DoneEvent> done;
  std::optional<protocol::FaultEvent> fault;

  bool collect(capture::TriggerLink& link) {
    return eventually([&] {
      while (const auto event = link.next_event()) {
        if (event->type == Type::kFrameEvent) frames.push_back(event->frame);
        if (event->type == Type::kDoneEvent) done = event->done;
        if (event->type == Type::kFaultEvent) fault = event->fault;
      }
      return done || fault;
    });
  }
};

capture::TriggerConfig patient(const std::string& tty) {
  capture::TriggerConfig config;
  config.tty = tty;
  config.reply_ms = 1000;
  config.lost_ms = 5000;
  return config;
}

}  // namespace

TEST_CASE("the appliance identifies the emulated board and runs a sequence to its end", "[emulator]") {
  const Mcu mcu = GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p);
  Rig rig(mcu);
  LiveLine line(rig.chip);
  capture::TriggerLink link(patient(line.tty()));
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  CHECK(link.identity()->board ==
        (mcu == Mcu::kAtmega2560 ? protocol::BoardKind::kAtmega2560 : protocol::BoardKind::kAtmega328p));
  CHECK(link.inputs().belt_stopped);

  const auto plan = emulator::sequence(0, 22);
  const auto id = link.arm(plan);
  REQUIRE(id);
  {
    const auto held = line.hold();
    rig.edges.clear();
  }
  REQUIRE(link.start_sequence(*id));
  Events events;
  REQUIRE(events.collect(link));
  CHECK_FALSE(events.fault);
  CHECK(events.frames.size() == 22);
  CHECK(link.events_lost() == 0);
  const auto held = line.hold();
  const std::int64_t worst = emulator::worst_deviation(rig.edges, plan);
  CHECK(worst >= 0);
  CHECK(worst <= 4);
}

TEST_CASE("over a line that damages one byte in a hundred the appliance gets every request through", "[emulator]") {
  Rig rig(Mcu::kAtmega328p);
  LiveLine line(rig.chip);
  line.set_noise(0.01);
  capture::TriggerLink link({.tty = line.tty(), .lost_ms = 5000});
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));
  for (int i = 0; i < 40; ++i) {
    const auto id = link.arm(emulator::sequence(0, 2));
    INFO("request " << i << ": " << (id ? "" : id.error().text()));
    REQUIRE(id);
    REQUIRE(link.abort());
    REQUIRE(link.refresh_status());
    CHECK(link.status().arm_id == *id);
    CHECK(link.status().state == protocol::State::kIdle);
  }
}

TEST_CASE("the appliance is told what goes wrong at the board, and finds the way out", "[emulator]") {
  Rig rig(Mcu::kAtmega328p);
  LiveLine line(rig.chip);
  capture::TriggerLink link(patient(line.tty()));
  link.start();
  REQUIRE(eventually([&] { return link.connected(); }));

  auto unplayable = emulator::sequence(0, 2);
  unplayable.groups[0].exposure_us = 10;
  const auto refused = link.arm(unplayable);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ResultCode::kValueOutOfRange);

  {
    const auto held = line.hold();
    rig.strobes = false;
  }
  auto id = link.arm(emulator::sequence(0, 5));
  REQUIRE(id);
  REQUIRE(link.start_sequence(*id));
  Events missing;
  REQUIRE(missing.collect(link));
  REQUIRE(missing.fault);
  CHECK(missing.fault->fault == protocol::Fault::kStrobeMissing);
  CHECK(missing.fault->frame == 0);
  {
    const auto held = line.hold();
    rig.strobes = true;
    CHECK(rig.safe());
    rig.chip.set_pin(In::kEmergencyStop, true);
  }
  REQUIRE(eventually([&] { return link.inputs().emergency_stop; }));
  const auto pressed = link.clear();
  REQUIRE_FALSE(pressed);
  {
    const auto held = line.hold();
    rig.chip.set_pin(In::kEmergencyStop, false);
  }
  REQUIRE(eventually([&] { return !link.inputs().emergency_stop; }));
  REQUIRE(link.clear());
  id = link.arm(emulator::sequence(0, 3));
  REQUIRE(id);
  REQUIRE(link.start_sequence(*id));
  Events whole;
  REQUIRE(whole.collect(link));
  CHECK(whole.done);
  CHECK(whole.frames.size() == 3);
}
