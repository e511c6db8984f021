// What goes wrong at the pins, and what the real firmware does about it: safe pins, the right fault, a way out.
#include <algorithm>
#include <cstdio>

#include "base/random.hpp"
#include "emulator/rig.hpp"

using namespace emulator;
using protocol::Fault;
using protocol::Refusal;
using protocol::State;
using protocol::Type;

namespace {

void check_way_out(Rig& rig, std::uint16_t arm_id) {
  CHECK(rig.safe());
  CHECK(rig.chip.level(Out::kFault));
  rig.chip.set_pin(In::kStrobe, false);
  rig.strobes = true;
  REQUIRE(rig.request(Type::kClear, protocol::Empty()) == Refusal::kNone);
  rig.run_us(1000);
  CHECK_FALSE(rig.chip.level(Out::kFault));
  const auto arm = sequence(arm_id, 3);
  rig.arm_and_start(arm);
  rig.run_us(45000);
  const std::int64_t worst = worst_deviation(rig.edges, arm);
  CHECK(worst >= 0);
  CHECK(worst <= 4);
  CHECK(rig.status().state == State::kDone);
}

void check_fault(Rig& rig, Fault fault, std::uint16_t frame) {
  const auto faults = rig.events<protocol::FaultEvent>(Type::kFaultEvent);
  REQUIRE_FALSE(faults.empty());
  CHECK(faults.back().fault == fault);
  CHECK(faults.back().frame == frame);
  CHECK(rig.status().fault == fault);
}

}  // namespace

TEST_CASE("a strobe that stays away faults with its frame", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  rig.arm_and_start(sequence(1, 9));
  rig.run_us(2 * 12500);
  rig.strobes = false;
  rig.run_us(12500);
  check_fault(rig, Fault::kStrobeMissing, 2);
  check_way_out(rig, 2);
}

TEST_CASE("a strobe line that sticks high faults as too long", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  rig.arm_and_start(sequence(1, 9));
  rig.strobe_fall_delay = 300 * kCyclesPerUs;
  rig.run_us(14000);
  check_fault(rig, Fault::kStrobeTooLong, 0);
  rig.strobe_fall_delay = 25 * kCyclesPerUs;
  check_way_out(rig, 2);
}

TEST_CASE("a glitch of the strobe line, however short, leaves no state behind", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  beltpick::Random random(5);
  std::uint16_t arm_id = 0;
  for (std::uint64_t length = 1; length <= 160; ++length) {
    for (int phase = 0; phase < 3; ++phase) {
      const std::uint64_t rise = rig.chip.cycle() + 100 + random.below(400);
      rig.post(Type::kKeepalive, protocol::Empty());
      rig.chip.at(rise, [&rig] { rig.chip.set_pin(In::kStrobe, true); });
      rig.chip.at(rise + length, [&rig] { rig.chip.set_pin(In::kStrobe, false); });
      rig.run_us(2000);
      auto arm = sequence(++arm_id, 1);
      arm.groups[0] = {1, 100, 50, 500, 20, 0};
      REQUIRE(rig.request(Type::kArm, arm) == Refusal::kNone);
      INFO("a glitch of " << length << " cycles");
      REQUIRE(rig.request(Type::kStart, protocol::Start{arm_id}) == Refusal::kNone);
      rig.run_us(2000);
      REQUIRE(rig.status().state == State::kDone);
    }
  }
}

TEST_CASE("a belt that moves ends the sequence", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  rig.arm_and_start(sequence(1, 9));
  rig.run_us(12500 + 4000);
  REQUIRE(rig.chip.level(Out::kCamera));
  const std::uint64_t moved = rig.chip.cycle() + 1;
  rig.chip.at(moved, [&rig] { rig.chip.set_pin(In::kBeltStopped, true); });
  rig.run_us(3000);
  CHECK(rig.safe());
  const auto fall = std::find_if(rig.edges.begin(), rig.edges.end(),
                                 [&](const PinEdge& e) { return e.pin == Out::kCamera && e.cycle > moved; });
  REQUIRE(fall != rig.edges.end());
  std::printf("belt moves: camera low after %llu cycles\n", static_cast<unsigned long long>(fall->cycle - moved));
  CHECK(fall->cycle - moved < 1000 * kCyclesPerUs);
  check_fault(rig, Fault::kBeltMoved, 1);
  rig.chip.set_pin(In::kBeltStopped, false);
  check_way_out(rig, 2);
}

TEST_CASE("a host that falls silent ends the sequence", "[emulator]") {
  Rig rig(Mcu::kAtmega328p);
  auto arm = sequence(1, 30);
  arm.host_silence_ms = 60;
  rig.arm_and_start(arm);
  rig.run_us(59000);
  CHECK(rig.chip.level(Out::kBusy));
  rig.run_us(4000);
  CHECK(rig.safe());
  rig.run_us(3000);
  check_fault(rig, Fault::kHostSilent, 4);
  check_way_out(rig, 2);
}

TEST_CASE("a main loop that hangs is reset by the watchdog, and tells so", "[emulator]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  rig.arm_and_start(sequence(1, 400));
  rig.run_us(30000);
  REQUIRE(rig.chip.resets() == 0);
  rig.chip.hang();
  const std::uint64_t hung = rig.chip.cycle();
  while (rig.chip.resets() == 0 && rig.chip.cycle() - hung < 16'000'000) rig.run_us(1000);
  REQUIRE(rig.chip.resets() == 1);
  const auto until_reset_ms = (rig.chip.cycle() - hung) / kCyclesPerUs / 1000;
  std::printf("hang to reset: %llu ms\n", static_cast<unsigned long long>(until_reset_ms));
  CHECK(until_reset_ms <= 300);
  rig.run_us(200000);
  CHECK(rig.safe());
  const auto identity = rig.ask(Type::kIdentify, protocol::Empty()).as<protocol::Identity>();
  CHECK((identity.reset_cause & protocol::kResetWatchdog) != 0);
  check_fault(rig, Fault::kWatchdogReset, protocol::kNoFrame);
  check_way_out(rig, 2);
}
