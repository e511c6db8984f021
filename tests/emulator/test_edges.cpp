// The edges of the real firmware, to the clock cycle.
#include <algorithm>
#include <cstdio>

#include "base/random.hpp"
#include "emulator/rig.hpp"

using namespace emulator;
using protocol::Refusal;
using protocol::State;
using protocol::Type;

namespace {
constexpr std::int64_t kToleranceCycles = 4;

// How far a measured time is off the cycles that it measures, in whole ticks.
std::int64_t ticks_off(std::uint32_t ticks, std::uint64_t from_cycle, std::uint64_t to_cycle) {
  constexpr std::int64_t kCyclesPerTick = 8;
  const auto cycles = static_cast<std::int64_t>(to_cycle - from_cycle);
  return std::abs(static_cast<std::int64_t>(ticks) * kCyclesPerTick - cycles) / kCyclesPerTick;
}

std::uint64_t first_advance(const std::vector<PinEdge>& edges) {
  return std::find_if(edges.begin(), edges.end(), [](const PinEdge& e) { return e.pin == Out::kProjector; })->cycle;
}

// STATUS after STATUS, the longest message there is, and now and then a byte of noise.
void load_line(Rig& rig, beltpick::Random& random, int milliseconds) {
  auto longest = sequence(1, 1);
  longest.group_count = protocol::kMaxGroups;
  for (protocol::Group& group : longest.groups) group = longest.groups[0];
  for (int ms = 0; ms < milliseconds; ms += 2) {
    rig.post(Type::kStatus, protocol::Empty());
    if (ms % 10 == 0) rig.post(Type::kArm, longest);
    if (ms % 14 == 0) rig.chip.send({static_cast<std::uint8_t>(random.below(256)), 0});
    rig.run_us(2000);
  }
}

}  // namespace

TEST_CASE("every edge of a 22-frame sequence comes at its cycle, and every strobe is measured", "[emulator][edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  const auto arm = sequence(7, 22);
  rig.arm_and_start(arm);
  rig.run_us(22 * 12500 + 5000);
  const std::int64_t worst = worst_deviation(rig.edges, arm);
  std::printf("22 frames: worst edge %lld cycles off its plan, stack %zu bytes\n", static_cast<long long>(worst),
              rig.chip.stack_bytes());
  CHECK(worst >= 0);
  CHECK(worst <= kToleranceCycles);
  const auto frames = rig.events<protocol::FrameEvent>(Type::kFrameEvent);
  REQUIRE(frames.size() == 22);
  REQUIRE(rig.strobe_edges.size() == 44);
  const std::uint64_t first_cycle = first_advance(rig.edges);
  for (std::uint16_t i = 0; i < 22; ++i) {
    CHECK(frames[i].frame == i);
    CHECK(frames[i].trigger_number == i + 1U);
    CHECK(frames[i].pulse_ticks == 2 * (i * 12500U + 1000U));
    const std::uint64_t rise = rig.strobe_edges[2 * i].cycle;
    const std::uint64_t fall = rig.strobe_edges[2 * i + 1].cycle;
    CHECK(ticks_off(frames[i].strobe_ticks, first_cycle, rise) <= 1);
    CHECK(ticks_off(frames[i].strobe_length_ticks, rise, fall) <= 1);
  }
  const auto done = rig.events<protocol::DoneEvent>(Type::kDoneEvent);
  REQUIRE(done.size() == 1);
  CHECK(done[0].duration_ticks == 2 * 22 * 12500);
  CHECK(rig.status().state == State::kDone);
  CHECK(rig.chip.level(Out::kDone));
  CHECK(rig.safe());
}

TEST_CASE("groups with other exposures, the shortest and the longest times, keep to the plan", "[emulator][edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  auto arm = sequence(1, 3);
  arm.group_count = 5;
  arm.groups[0].readout_us = 3000;
  arm.groups[1] = {4, 100, 50, 500, 20};           // the shortest pulse, advance and pulse edge at once
  arm.groups[2] = {2, 20000, 40000, 100000, 100};  // longer than the timer's turn
  arm.groups[3] = {1, 65636, 300, 70000, 100};
  arm.groups[4] = {5, 500, 700, 1500, 500};
  rig.arm_and_start(arm);
  rig.run_us(450000);
  CHECK(rig.status().fault == protocol::Fault::kNone);
  const std::int64_t worst = worst_deviation(rig.edges, arm);
  CHECK(worst >= 0);
  CHECK(worst <= kToleranceCycles);
}

TEST_CASE("10,000 frames under a loaded serial line keep to their cycles, and none is lost", "[emulator][edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  beltpick::Random random(5);
  std::int64_t worst = 0;
  for (std::uint16_t id = 1; id <= 20; ++id) {
    auto arm = sequence(id, 500);
    arm.groups[0] = {499, 300, 700, 1500, 700};
    arm.groups[1] = {1, 300, 60000, 100000, 700};
    arm.group_count = 2;
    const std::size_t before = rig.messages.size();
    rig.arm_and_start(arm);
    load_line(rig, random, 900);
    const std::int64_t deviation = worst_deviation(rig.edges, arm);
    INFO("sequence " << id << ", fault " << static_cast<int>(rig.status().fault));
    REQUIRE(deviation >= 0);
    worst = std::max(worst, deviation);
    rig.messages.erase(rig.messages.begin(), rig.messages.begin() + static_cast<std::ptrdiff_t>(before));
    REQUIRE(rig.events<protocol::FrameEvent>(Type::kFrameEvent).size() == 500);
  }
  std::printf("10,000 frames under a loaded line: worst edge %lld cycles off its plan\n",
              static_cast<long long>(worst));
  CHECK(worst <= kToleranceCycles);
}

TEST_CASE("the START pin starts what is armed, once", "[emulator][edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  REQUIRE(rig.request(Type::kArm, sequence(1, 2)) == Refusal::kNone);
  rig.edges.clear();
  rig.chip.set_pin(In::kStart, false);
  rig.run_us(2000);
  CHECK(rig.chip.level(Out::kBusy));
  rig.chip.set_pin(In::kStart, true);
  rig.chip.set_pin(In::kStart, false);
  rig.run_us(30000);
  CHECK(worst_deviation(rig.edges, sequence(1, 2)) >= 0);
  CHECK(rig.status().state == State::kDone);
}

TEST_CASE("what the board cannot play is refused with its reason and moves no pin", "[emulator][edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  auto arm = sequence(1, 2);
  arm.groups[0].exposure_us = 49;
  CHECK(rig.request(Type::kArm, arm) == Refusal::kIntervalTooShort);
  arm = sequence(1, 2);
  arm.groups[0] = {2, 100, 50, 499, 20};
  CHECK(rig.request(Type::kArm, arm) == Refusal::kPeriodTooShort);
  arm = sequence(1, 2);
  arm.groups[0].readout_us = 4501;
  CHECK(rig.request(Type::kArm, arm) == Refusal::kPeriodTooShort);
  arm.groups[0].period_us = protocol::kMaxPeriod_us + 1;
  CHECK(rig.request(Type::kArm, arm) == Refusal::kPeriodTooLong);
  arm.groups[0].exposure_us = protocol::kMaxExposure_us + 1;
  CHECK(rig.request(Type::kArm, arm) == Refusal::kPeriodTooLong);
  arm.groups[0].period_us = protocol::kMaxPeriod_us;
  CHECK(rig.request(Type::kArm, arm) == Refusal::kExposureOutOfRange);
  CHECK(rig.request(Type::kStart, protocol::Start{1}) == Refusal::kNotArmed);
  CHECK(rig.edges.empty());
}
