#include <catch2/catch.hpp>

#include "bench.hpp"

using namespace bench;
using protocol::Refusal;
using protocol::State;

TEST_CASE("every edge of a sequence comes at its time, also where the clock wraps", "[sequencer]") {
  for (const std::uint32_t t0 : {0U, 1000U, 0xFFFFFFFFU - 15000U}) {
    Bench bench(kStands, t0);
    bench.arm_and_start(sequence(1, 2));
    bench.run_for(30000);
    const std::vector<Edge> expected{{'p', true, t0},          {'b', true, t0},         {'p', false, t0 + 100},
                                     {'c', true, t0 + 1000},   {'c', false, t0 + 9000}, {'p', true, t0 + 12500},
                                     {'p', false, t0 + 12600}, {'c', true, t0 + 13500}, {'c', false, t0 + 21500},
                                     {'b', false, t0 + 25000}, {'d', true, t0 + 25000}};
    CHECK(bench.edges == expected);
    CHECK(bench.status().state == State::kDone);
    CHECK(bench.status().frames_done == 2);
    const auto done = bench.events<protocol::DoneEvent>();
    REQUIRE(done.size() == 1);
    CHECK(done[0].duration_ticks == core::ticks_of(25000));
    CHECK(done[0].frames == 2);
  }
}

TEST_CASE("each group runs with its own exposure and settle time", "[sequencer]") {
  auto arm = sequence(5, 1);
  arm.group_count = 2;
  arm.groups[1] = {1, 2000, 500, 6000, 3000};
  Bench bench;
  bench.arm_and_start(arm);
  bench.run_for(20000);
  std::vector<Edge> camera;
  for (const Edge& edge : bench.edges) {
    if (edge.pin == 'c') camera.push_back(edge);
  }
  CHECK(camera == std::vector<Edge>{{'c', true, 1000}, {'c', false, 9000}, {'c', true, 14500}, {'c', false, 15000}});
  CHECK(bench.status().state == State::kDone);
}

TEST_CASE("a frame is told with its measured strobe and a trigger number that runs on", "[sequencer]") {
  Bench bench;
  std::uint32_t trigger = 0;
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{10, 11}) {
    const std::uint32_t start_us = bench.now_us;
    bench.arm_and_start(sequence(id, 3));
    for (std::uint16_t frame = 0; frame < 3; ++frame) {
      bench.run_for(12500);
      const auto events = bench.events<protocol::FrameEvent>();
      REQUIRE(events.size() == 1);
      CHECK(events[0].arm_id == id);
      CHECK(events[0].frame == frame);
      CHECK(events[0].trigger_number == ++trigger);
      CHECK(events[0].pulse_ticks == core::ticks_of(frame * 12500U + 1000U));
      CHECK(events[0].strobe_ticks == core::ticks_of(frame * 12500U + 1020U));
      CHECK(events[0].strobe_length_ticks == core::ticks_of(8005));
    }
    CHECK(bench.now_us == start_us + 37500);
  }
  CHECK(bench.status().trigger_number == 6);
}

TEST_CASE("arming again with the same content changes nothing, with another it is refused", "[sequencer]") {
  Bench bench;
  CHECK(bench.sequencer.arm(sequence(1, 2)) == Refusal::kNone);
  CHECK(bench.sequencer.arm(sequence(1, 2)) == Refusal::kNone);
  auto other = sequence(1, 2);
  other.groups[0].exposure_us += 1;
  CHECK(bench.sequencer.arm(other) == Refusal::kArmIdUsed);
  CHECK(bench.sequencer.arm(sequence(0, 2)) == Refusal::kArmIdUsed);  // 0 means "none"
  CHECK(bench.sequencer.arm(sequence(2, 3)) == Refusal::kNone);
  CHECK(bench.start(1) == Refusal::kNotArmed);
  CHECK(bench.status().arm_id == 2);
}

TEST_CASE("START fires once for an ARM, however often it is repeated", "[sequencer]") {
  Bench bench;
  CHECK(bench.start(0) == Refusal::kNotArmed);
  bench.sequencer.arm(sequence(1, 1));
  CHECK(bench.start(1) == Refusal::kNone);
  CHECK(bench.start(1) == Refusal::kNone);
  bench.run_for(5000);
  CHECK(bench.start(1) == Refusal::kNone);
  CHECK(bench.sequencer.arm(sequence(2, 1)) == Refusal::kSequenceRunning);
  bench.run_for(10000);
  CHECK(bench.start(1) == Refusal::kNone);
  CHECK(bench.sequencer.arm(sequence(1, 1)) == Refusal::kArmIdUsed);
  bench.run_for(30000);
  CHECK(bench.status().trigger_number == 1);
}

TEST_CASE("a board that prepares its edges gets a lead, and every time counts from the first frame", "[sequencer]") {
  core::BoardTiming board;
  board.start_lead_us = 1000;
  Bench bench;
  bench.sequencer = core::Sequencer(kStands, 0, board);
  bench.sequencer.arm(sequence(1, 2));
  CHECK(bench.sequencer.start_by_pin(0) == Refusal::kNone);
  CHECK(bench.sequencer.running());
  CHECK(bench.sequencer.start_ticks() == core::ticks_of(1000));
  CHECK(bench.sequencer.outputs().busy);
  CHECK_FALSE(bench.sequencer.outputs().projector);
  core::EdgeWalk walk;
  walk.start(bench.sequencer.start_ticks());
  std::vector<std::uint32_t> ahead;
  for (; walk.edge() != core::Edge::kSequenceEnds; walk.pass(bench.sequencer.plan()))
    ahead.push_back(walk.at_ticks() / 2);
  bench.run_for(30000);
  std::vector<std::uint32_t> seen;
  for (const Edge& edge : bench.edges) {
    if (edge.pin == 'p' || edge.pin == 'c') seen.push_back(edge.at_us);
  }
  CHECK(seen == ahead);
  const auto frames = bench.events<protocol::FrameEvent>();
  REQUIRE(frames.size() == 2);
  CHECK(frames[0].pulse_ticks == core::ticks_of(1000));
}

TEST_CASE("the START input starts nothing that is not armed", "[sequencer]") {
  Bench bench;
  CHECK(bench.sequencer.start_by_pin(0) == Refusal::kNotArmed);
  CHECK_FALSE(bench.sequencer.running());
}

TEST_CASE("a sequence does not start over a moving belt or an exposing camera", "[sequencer]") {
  Bench bench(kMoves);
  bench.sequencer.arm(sequence(1, 1));
  CHECK(bench.start(1) == Refusal::kBeltNotStopped);
  bench.inputs(kStands);
  bench.strobe(true);
  CHECK(bench.start(1) == Refusal::kStrobeActive);
  bench.strobe(false);
  CHECK(bench.start(1) == Refusal::kNone);
}

TEST_CASE("ABORT makes the outputs safe and disarms, in every state", "[sequencer]") {
  Bench bench;
  bench.sequencer.abort();
  CHECK(bench.status().state == State::kIdle);
  bench.sequencer.arm(sequence(1, 1));
  bench.sequencer.abort();
  CHECK(bench.start(1) == Refusal::kNotArmed);
  bench.arm_and_start(sequence(2, 1));
  bench.run_for(3000);
  REQUIRE(bench.sequencer.outputs().camera);
  bench.sequencer.abort();
  CHECK(bench.safe());
  CHECK(bench.status().state == State::kIdle);
  bench.run_for(50000);
  CHECK(bench.safe());
}

TEST_CASE("a DONE that the line could not tell before the next ARM is that of its own sequence", "[sequencer]") {
  Bench bench;
  bench.arm_and_start(sequence(1, 1));
  bench.run_for(20000);
  REQUIRE(bench.sequencer.arm(sequence(2, 1)) == Refusal::kNone);
  const auto events = bench.events<protocol::DoneEvent>();
  REQUIRE(events.size() == 1);
  CHECK(events[0].arm_id == 1);
  CHECK(events[0].frames == 1);
}

TEST_CASE("DONE stays until the next ARM", "[sequencer]") {
  Bench bench;
  bench.arm_and_start(sequence(1, 1));
  bench.run_for(20000);
  CHECK(bench.sequencer.outputs().done);
  bench.sequencer.arm(sequence(2, 1));
  CHECK_FALSE(bench.sequencer.outputs().done);
}

TEST_CASE("inputs are told when they change and only then", "[sequencer]") {
  Bench bench(kMoves);
  bench.inputs(kMoves);
  CHECK(bench.events<protocol::InputsEvent>().empty());
  bench.run_for(77);
  bench.inputs(kStands);
  const auto events = bench.events<protocol::InputsEvent>();
  REQUIRE(events.size() == 1);
  CHECK(events[0].inputs == kStands);
  CHECK(events[0].now_ticks == core::ticks_of(77));
}
