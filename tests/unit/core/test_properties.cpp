// Random worlds: whatever arrives in whatever order, the promises of PROTOCOL.md hold and every state has a way out.
#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "bench.hpp"

using namespace bench;
using protocol::Refusal;
using protocol::State;

namespace {

protocol::Arm random_sequence(beltpick::Random& random, std::uint16_t arm_id) {
  auto arm = sequence(arm_id, static_cast<std::uint16_t>(1 + random.below(4)));
  arm.host_silence_ms = static_cast<std::uint16_t>(random.below(60));
  arm.group_count = static_cast<std::uint8_t>(random.below(4));
  for (std::uint8_t i = 1; i < arm.group_count; ++i) {
    arm.groups[i] = arm.groups[0];
    arm.groups[i].settle_us = random.below(3000);
    arm.groups[i].exposure_us = random.below(12000);
  }
  return arm;
}

void random_step(Bench& bench, beltpick::Random& random, std::uint16_t& arm_id) {
  const std::uint8_t inputs = static_cast<std::uint8_t>(random.below(12) == 0 ? random.below(4) : kStands);
  switch (random.below(9)) {
    case 0:
      arm_id = static_cast<std::uint16_t>(arm_id + random.below(2));
      bench.sequencer.arm(random_sequence(random, arm_id));
      break;
    case 1:
      bench.start(arm_id);
      break;
    case 2:
      if (random.below(8) == 0) bench.sequencer.abort();
      break;
    case 3:
      bench.sequencer.clear();
      break;
    case 4:
      if (random.below(8) == 0) bench.strobe(random.below(2) == 0);
      break;
    case 5:
      bench.inputs(inputs);
      break;
    case 6:
      bench.strobe_rise_delay_us = random.below(10) == 0 ? std::optional<std::uint32_t>() : random.below(210);
      bench.strobe_fall_delay_us = random.below(210);
      break;
    default:
      bench.run_for(random.below(20000));
      bench.host_spoke();
      bench.events<protocol::FrameEvent>();
  }
}

void check_promises(const Bench& bench) {
  const auto out = bench.sequencer.outputs();
  const auto status = bench.status();
  REQUIRE(out.busy == (status.state == State::kRunning));
  REQUIRE(out.done == (status.state == State::kDone));
  REQUIRE(out.fault == (status.state == State::kFault));
  REQUIRE((status.state == State::kFault) == (status.fault != protocol::Fault::kNone));
  if (status.state != State::kRunning) REQUIRE(bench.safe());
  if ((status.inputs & protocol::kInputEmergencyStop) != 0) REQUIRE(status.state == State::kFault);
  if ((status.inputs & protocol::kInputBeltStopped) == 0) REQUIRE(status.state != State::kRunning);
  std::uint32_t at_us = 0;
  REQUIRE(bench.next_deadline(at_us) == (status.state == State::kRunning));
}

// Whatever happened: release the stop, let the belt stand, clear, and a capture runs to its end.
void check_way_out(Bench bench, std::uint16_t arm_id) {
  bench.inputs(kStands);
  bench.sequencer.abort();
  bench.strobe(false);
  REQUIRE(bench.sequencer.clear() == Refusal::kNone);
  bench.run_for(300);  // a strobe that was under way ends
  bench.strobe(false);
  bench.strobe_rise_delay_us = 20;
  bench.strobe_fall_delay_us = 25;
  bench.events<protocol::FrameEvent>();
  REQUIRE(bench.sequencer.arm(sequence(arm_id, 3)) == Refusal::kNone);
  REQUIRE(bench.start(arm_id) == Refusal::kNone);
  bench.run_for(40000);
  REQUIRE(bench.status().state == State::kDone);
}

}  // namespace

TEST_CASE("random worlds keep the outputs safe and leave a way out of every state", "[properties]") {
  int runs_done = 0;
  int faults = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    beltpick::Random random(seed);
    Bench bench(static_cast<std::uint8_t>(random.below(4)), random.next());
    std::uint16_t arm_id = 1;
    for (int step = 0; step < 1500; ++step) {
      random_step(bench, random, arm_id);
      check_promises(bench);
      runs_done += bench.events<protocol::DoneEvent>().empty() ? 0 : 1;
      faults += bench.events<protocol::FaultEvent>().empty() ? 0 : 1;
      if (step % 50 == 0) check_way_out(bench, static_cast<std::uint16_t>(arm_id + 1000));
    }
  }
  // The random worlds are worth something only when they reach both ends.
  CHECK(runs_done > 100);
  CHECK(faults > 200);
}

TEST_CASE("no camera pulse is ever longer than armed, and none begins while the strobe is high", "[properties]") {
  for (std::uint64_t seed = 100; seed < 120; ++seed) {
    beltpick::Random random(seed);
    Bench bench(kStands, random.next());
    bench.arm_and_start(sequence(1, 6));
    for (int step = 0; step < 30; ++step) {
      bench.strobe_rise_delay_us = random.below(260);
      bench.strobe_fall_delay_us = random.below(260);
      bench.run_for(random.below(5000));
    }
    std::uint32_t rise_us = 0;
    for (const Edge& edge : bench.edges) {
      if (edge.pin != 'c') continue;
      if (edge.level) rise_us = edge.at_us;
      if (!edge.level) CHECK(edge.at_us - rise_us <= 8000);
    }
  }
}
