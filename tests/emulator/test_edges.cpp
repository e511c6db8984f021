// The edges of the real firmware, to the clock cycle.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/random.hpp"
#include "core/plan.hpp"
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

// Keeps the line busy for as long as the sequence runs, towards the board without a pause: STATUS, the longest ARM, and
// damaged bytes in between.
class LineLoad {
 public:
  explicit LineLoad(Rig& rig) : rig_(rig), longest_(sequence(1, 1)) {
    longest_.group_count = protocol::kMaxGroups;
    for (protocol::Group& group : longest_.groups) group = longest_.groups[0];
  }

  void run_us(std::uint64_t us) {
    const std::uint64_t until = rig_.chip.cycle() + us * kCyclesPerUs;
    for (int slice = 0; rig_.chip.cycle() < until; ++slice) {
      room_ += 100;  // bytes that the line carries in two milliseconds
      room_ -= static_cast<int>(rig_.post(Type::kStatus, protocol::Empty()));
      if (slice % 5 == 0) room_ -= static_cast<int>(rig_.post(Type::kArm, longest_));
      std::vector<std::uint8_t> noise(static_cast<std::size_t>(std::max(room_, 1)));
      for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random_.below(256));
      noise.back() = 0;
      room_ -= static_cast<int>(noise.size());
      rig_.chip.send(noise);
      rig_.run_us(2000);
    }
  }

 private:
  Rig& rig_;
  beltpick::Random random_{5};
  protocol::Arm longest_;
  int room_ = 0;
};

std::uint64_t duration_us(const protocol::Arm& arm) {
  std::uint64_t sum = 0;
  for (std::uint8_t i = 0; i < arm.group_count; ++i)
    sum += std::uint64_t{arm.groups[i].frames} * arm.groups[i].period_us;
  return sum;
}

// What a sequence of 500 frames holds: most at 1.5 ms, three HDR exposures of the same patterns, and single frames of
// random periods up to 100 ms.
protocol::Arm mixed_sequence(std::uint16_t arm_id, beltpick::Random& random) {
  auto arm = sequence(arm_id, 500);
  arm.group_count = protocol::kMaxGroups;
  arm.groups[0] = {260, 300, 700, 1500, 700, 0};
  arm.groups[1] = {78, 200, 350, 1700, 1600, 40};
  arm.groups[2] = {78, 300, 1400, 2600, 1200, 0};
  arm.groups[3] = {78, 400, 2800, 4000, 1000, 0};
  for (std::uint8_t i = 4; i < protocol::kMaxGroups; ++i) {
    const std::uint32_t period_us = 1500 + random.below(i == 7 ? 98501 : 20000);
    const std::uint32_t exposure_us = 50 + random.below(period_us - 1400);
    arm.groups[i] = {static_cast<std::uint16_t>(i == 7 ? 1 : 2 - i % 2), 400, exposure_us, period_us, 100, 0};
  }
  arm.groups[7].frames = static_cast<std::uint16_t>(500 - 260 - 3 * 78 - 2 - 1 - 2);
  return arm;
}

// Runs whole sequences under load up to 10,000 frames: every edge within 4 cycles of the plan from the first advance
// on, so that nothing drifts, and every frame told.
void run_10000_frames(Rig& rig, protocol::Arm (*plan)(std::uint16_t, beltpick::Random&)) {
  LineLoad load(rig);
  beltpick::Random random(8);
  std::int64_t worst = 0;
  int frames = 0;
  for (std::uint16_t id = 1; frames < 10000; ++id) {
    const auto arm = plan(id, random);
    rig.messages.clear();
    rig.arm_and_start(arm);
    load.run_us(duration_us(arm) + 3000);
    const std::int64_t deviation = worst_deviation(rig.edges, arm);
    rig.run_us(10000);
    INFO("sequence " << id << ", fault " << static_cast<int>(rig.status().fault));
    REQUIRE(deviation >= 0);
    worst = std::max(worst, deviation);
    const int told = static_cast<int>(rig.events<protocol::FrameEvent>(Type::kFrameEvent).size());
    REQUIRE(told == beltpick::core::total_frames(arm));
    frames += told;
  }
  std::printf("%d frames under a full line: worst edge %lld cycles off its plan\n", frames,
              static_cast<long long>(worst));
  CHECK(worst <= kToleranceCycles);
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

TEST_CASE("10,000 frames of 1.5 to 100 ms under a full serial line keep to their cycles, and none is lost",
          "[emulator][edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  run_10000_frames(rig, mixed_sequence);
}

// A minute: by hand, `test_emulator "[long-edges]"`.
TEST_CASE("10,000 frames, each group of another period of 1.5 to 100 ms", "[.][long-edges]") {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  run_10000_frames(rig, [](std::uint16_t arm_id, beltpick::Random& random) {
    auto arm = sequence(arm_id, 0);
    arm.group_count = protocol::kMaxGroups;
    for (protocol::Group& group : arm.groups) {
      const auto period_us = static_cast<std::uint32_t>(1500 * std::exp(random.uniform() * std::log(100.0 / 1.5)));
      const std::uint32_t exposure_us = 50 + random.below(period_us - 1400);
      group = {16, 400, exposure_us, period_us, 100, 0};
    }
    return arm;
  });
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
