#include <catch2/catch.hpp>

#include "bench.hpp"

using namespace bench;
using protocol::Fault;
using protocol::Refusal;
using protocol::State;

namespace {

// The fault, its frame, safe outputs, the latch, and the way out.
void check_fault(Bench& bench, Fault fault, std::uint16_t frame) {
  CHECK(bench.status().state == State::kFault);
  CHECK(bench.status().fault == fault);
  CHECK(bench.status().fault_frame == frame);
  CHECK(bench.safe());
  CHECK(bench.sequencer.outputs().fault);
  const auto events = bench.events<protocol::FaultEvent>();
  REQUIRE(events.size() == 1);
  CHECK(events[0].fault == fault);
  CHECK(events[0].frame == frame);
  CHECK(bench.sequencer.arm(sequence(99, 1)) == Refusal::kFaultLatched);
  CHECK(bench.start(99) == Refusal::kFaultLatched);
  bench.sequencer.abort();
  CHECK(bench.status().state == State::kFault);
  bench.strobe_rise_delay_us = 20;
  bench.strobe_fall_delay_us = 25;
  bench.events<protocol::FrameEvent>();
  bench.inputs(kStands);
  bench.run_for(100000);
  CHECK(bench.sequencer.clear() == Refusal::kNone);
  bench.arm_and_start(sequence(100, 2));
  bench.run_for(50000);
  CHECK(bench.status().state == State::kDone);
}

// Two frames of the sequence have passed, the third begins.
Bench third_frame() {
  Bench bench;
  bench.arm_and_start(sequence(1, 5));
  bench.run_for(2 * 12500);
  bench.events<protocol::FrameEvent>();
  return bench;
}

}  // namespace

TEST_CASE("a strobe that does not come is missing at the end of the tolerance", "[faults]") {
  Bench bench = third_frame();
  bench.strobe_rise_delay_us.reset();
  bench.run_to(26000 + 199);
  CHECK(bench.status().state == State::kRunning);
  bench.run_to(26000 + 200);
  check_fault(bench, Fault::kStrobeMissing, 2);
}

TEST_CASE("a strobe before its pulse is early", "[faults]") {
  Bench bench = third_frame();
  bench.run_for(500);
  bench.strobe(true);
  bench.strobe(false);
  check_fault(bench, Fault::kStrobeEarly, 2);
}

TEST_CASE("a second strobe in a frame is double", "[faults]") {
  Bench bench = third_frame();
  bench.run_for(10000);
  bench.strobe(true);
  bench.strobe(false);
  check_fault(bench, Fault::kStrobeDouble, 2);
}

TEST_CASE("a strobe that outlasts the pulse by more than the tolerance is too long", "[faults]") {
  Bench bench = third_frame();
  bench.strobe_fall_delay_us = 201;
  bench.run_for(12000);
  check_fault(bench, Fault::kStrobeTooLong, 2);
}

TEST_CASE("a strobe just within the tolerance is none", "[faults]") {
  Bench bench = third_frame();
  bench.strobe_rise_delay_us = 199;
  bench.strobe_fall_delay_us = 199;
  bench.run_for(50000);
  CHECK(bench.status().state == State::kDone);
}

TEST_CASE("a strobe that ends before the exposure does is too short", "[faults]") {
  Bench bench = third_frame();
  bench.run_for(1000 + 20 + 7799);
  bench.strobe(false);
  check_fault(bench, Fault::kStrobeTooShort, 2);
}

TEST_CASE("a belt that moves during the sequence is a fault, before it is not", "[faults]") {
  Bench bench;
  bench.inputs(kMoves);
  CHECK(bench.status().state == State::kIdle);
  bench.inputs(kStands);
  bench.sequencer.arm(sequence(1, 5));
  bench.inputs(kMoves);
  bench.inputs(kStands);
  CHECK(bench.status().state == State::kArmed);
  bench.start(1);
  bench.run_for(15000);
  REQUIRE(bench.sequencer.outputs().camera);
  bench.inputs(kMoves);
  check_fault(bench, Fault::kBeltMoved, 1);
}

TEST_CASE("the emergency stop is a fault in every state and cannot be cleared while pressed", "[faults]") {
  SECTION("from the start") {
    Bench bench(kStopPressed);
    CHECK(bench.sequencer.clear() == Refusal::kEmergencyStopPressed);
    check_fault(bench, Fault::kEmergencyStop, protocol::kNoFrame);
  }
  SECTION("idle") {
    Bench bench;
    bench.inputs(kStopPressed);
    check_fault(bench, Fault::kEmergencyStop, protocol::kNoFrame);
  }
  SECTION("armed") {
    Bench bench;
    bench.sequencer.arm(sequence(1, 5));
    bench.inputs(kStopPressed);
    check_fault(bench, Fault::kEmergencyStop, protocol::kNoFrame);
  }
  SECTION("exposing") {
    Bench bench = third_frame();
    bench.run_for(3000);
    bench.inputs(kStopPressed);
    CHECK(bench.sequencer.clear() == Refusal::kEmergencyStopPressed);
    check_fault(bench, Fault::kEmergencyStop, 2);
  }
  SECTION("done") {
    Bench bench;
    bench.arm_and_start(sequence(1, 1));
    bench.run_for(20000);
    bench.inputs(kStopPressed);
    check_fault(bench, Fault::kEmergencyStop, protocol::kNoFrame);
  }
}

TEST_CASE("a host silent for longer than armed is a fault, one that speaks is not", "[faults]") {
  auto arm = sequence(1, 100);
  arm.host_silence_ms = 30;
  Bench bench;
  bench.arm_and_start(arm);
  for (int i = 0; i < 10; ++i) {
    bench.run_for(29000);
    bench.events<protocol::FrameEvent>();
    bench.host_spoke();
  }
  CHECK(bench.status().state == State::kRunning);
  bench.run_for(30000);
  CHECK(bench.status().state == State::kFault);
  check_fault(bench, Fault::kHostSilent, 25);
}

TEST_CASE("events that nobody takes are a fault before one is lost", "[faults]") {
  Bench bench;
  bench.arm_and_start(sequence(1, 10));
  bench.run_for(100000);
  CHECK(bench.events<protocol::FrameEvent>().size() == 4);
  check_fault(bench, Fault::kEventsLost, 4);
}

TEST_CASE("an edge served too late is a fault, a little late is not and shifts nothing", "[faults]") {
  Bench bench;
  bench.arm_and_start(sequence(1, 5));
  bench.sequencer.on_time(core::ticks_of(100 + core::BoardTiming().late_limit_us));
  std::uint32_t next_us = 0;
  REQUIRE(bench.next_deadline(next_us));
  CHECK(next_us == 1000);
  bench.sequencer.on_time(core::ticks_of(1000 + core::BoardTiming().late_limit_us) + 1);
  check_fault(bench, Fault::kTimerLate, 0);
}

TEST_CASE("an edge that the board's timer missed is a fault while a sequence runs, and nothing else", "[faults]") {
  Bench bench;
  bench.sequencer.on_late_edge();
  CHECK(bench.status().state == State::kIdle);
  bench = third_frame();
  bench.sequencer.on_late_edge();
  check_fault(bench, Fault::kTimerLate, 2);
}

TEST_CASE("a fault that is cleared before the line could tell it is told as it was", "[faults]") {
  Bench bench = third_frame();
  bench.inputs(kMoves);
  CHECK(bench.sequencer.clear() == Refusal::kNone);
  const auto events = bench.events<protocol::FaultEvent>();
  REQUIRE(events.size() == 1);
  CHECK(events[0].fault == Fault::kBeltMoved);
  CHECK(events[0].frame == 2);
  CHECK(events[0].arm_id == 1);
}

TEST_CASE("the first fault stays", "[faults]") {
  Bench bench = third_frame();
  bench.inputs(kMoves);
  bench.inputs(kStopPressed);
  CHECK(bench.status().fault == Fault::kBeltMoved);
  CHECK(bench.sequencer.clear() == Refusal::kEmergencyStopPressed);
  check_fault(bench, Fault::kBeltMoved, 2);
}
