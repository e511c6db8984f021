#include <catch2/catch.hpp>
#include <thread>

#include "base/clock.hpp"
#include "capture/lines/line_trigger.hpp"
#include "capture/lines/start_by_line.hpp"
#include "fake_gpio.hpp"

using namespace fake;

namespace {

constexpr int kLate_us = 100'000;  // this machine may be busy

template <class Condition>
bool eventually(Condition condition) {
  const std::int64_t until_us = monotonic_us() + 8'000'000;
  while (!condition()) {
    if (monotonic_us() > until_us) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

protocol::Arm sequence() {
  protocol::Arm arm;
  arm.host_silence_ms = 2000;
  arm.strobe_tolerance_us = kLate_us;
  arm.group_count = 2;
  arm.groups[0] = {5, 1000, 2000, 104'000, 1000};
  arm.groups[1] = {3, 1000, 4000, 106'000, 1000};
  return arm;
}

struct Bench {
  EchoGpio gpio;
  CellLines lines{{.belt_stopped = line("belt"), .emergency_stop = line("stop"), .debounce_ms = 0}};
  LineTrigger trigger{{line("camera"), line("projector"), line("strobe"), line("busy"), line("fault"), kLate_us},
                      lines};

  Bench() {
    gpio.wires["belt"].active = true;
    REQUIRE(lines.open(gpio));
    REQUIRE(trigger.open(gpio));
    lines.start();
    trigger.start();
  }
  // The code of its end, and the frames on the way.
  ResultCode run() {
    const auto armed = trigger.arm(sequence());
    if (!armed) return armed.error().code;
    if (const auto started = trigger.start_sequence(*armed); !started) return started.error().code;
    ResultCode code = ResultCode::kCaptureTimeout;
    frames = 0;
    eventually([&] {
      const auto event = trigger.next_event();
      if (!event) return false;
      if (event->type == protocol::Type::kFrameEvent) frames += event->frame.frame == frames ? 1 : 100;
      if (event->type == protocol::Type::kDoneEvent) code = ResultCode::kOk;
      if (event->type == protocol::Type::kFaultEvent) code = code_of(event->fault.fault);
      return event->type != protocol::Type::kFrameEvent;
    });
    return code;
  }
  bool safe() {
    return !gpio.wires["camera"].level() && !gpio.wires["projector"].level() && !gpio.wires["busy"].level();
  }

  int frames = 0;
};

}  // namespace

TEST_CASE("each pulse is driven once, and its strobe told", "[line trigger]") {
  Bench bench;
  REQUIRE(bench.trigger.connected());
  CHECK(bench.run() == ResultCode::kOk);
  CHECK(bench.frames == 8);
  CHECK(bench.gpio.wires["camera"].writes == 16);
  CHECK(bench.gpio.wires["projector"].writes == 16);
  CHECK(bench.gpio.wires["busy"].writes == 2);
  CHECK(bench.trigger.status().trigger_number == 8);
  CHECK(bench.safe());
  CHECK(bench.run() == ResultCode::kOk);
}

TEST_CASE("faults have the firmware's names, and end when they are cleared", "[line trigger]") {
  Bench bench;
  SECTION("no strobe") {
    bench.gpio.deaf = true;
    CHECK(bench.run() == code_of(protocol::Fault::kStrobeMissing));
    bench.gpio.deaf = false;
  }
  SECTION("belt") {
    std::thread hand([&] {
      eventually([&] { return bench.gpio.wires["busy"].level(); });
      bench.gpio.wires["belt"].edge(false, monotonic_us());
    });
    CHECK(bench.run() == ResultCode::kBeltMovedDuringCapture);
    hand.join();
    bench.gpio.wires["belt"].edge(true, monotonic_us());
  }
  SECTION("emergency stop") {
    bench.gpio.wires["stop"].edge(true, monotonic_us());
    REQUIRE(eventually([&] { return bench.trigger.status().fault == protocol::Fault::kEmergencyStop; }));
    CHECK(bench.gpio.wires["fault"].level());
    CHECK(bench.run() == ResultCode::kEmergencyStop);
    CHECK(bench.trigger.clear().error().code == ResultCode::kEmergencyStop);
    bench.gpio.wires["stop"].edge(false, monotonic_us());
  }
  CHECK(bench.safe());
  REQUIRE(eventually([&] { return bench.trigger.status().inputs == protocol::kInputBeltStopped; }));
  REQUIRE(bench.trigger.clear());
  while (bench.trigger.next_event()) {
  }
  CHECK_FALSE(bench.gpio.wires["fault"].level());
  CHECK(bench.run() == ResultCode::kOk);
}

TEST_CASE("a reader that falls silent ends the sequence", "[line trigger]") {
  Bench bench;
  protocol::Arm arm = sequence();
  arm.host_silence_ms = 20;
  const auto armed = bench.trigger.arm(arm);
  REQUIRE(armed);
  REQUIRE(bench.trigger.start_sequence(*armed));
  CHECK(eventually([&] { return bench.trigger.status().fault == protocol::Fault::kHostSilent; }));
  CHECK(bench.safe());
}

TEST_CASE("what a PC cannot follow is refused", "[line trigger]") {
  Bench bench;
  protocol::Arm arm = sequence();
  arm.strobe_tolerance_us = 100;
  arm.groups[0] = {5, 200, 300, 1000, 100};
  CHECK(bench.trigger.arm(arm).error().code == ResultCode::kValueOutOfRange);
}

TEST_CASE("lines that are lost are told as such, and their outputs made safe", "[line trigger]") {
  Bench bench;
  std::thread hand([&] {
    eventually([&] { return bench.gpio.wires["busy"].level(); });
    bench.gpio.wires["strobe"].take_away();
  });
  const auto armed = bench.trigger.arm(sequence());
  REQUIRE(armed);
  REQUIRE(bench.trigger.start_sequence(*armed));
  CHECK(eventually([&] { return !bench.trigger.connected(); }));
  hand.join();
  CHECK(bench.trigger.last_error().code == ResultCode::kLinesLost);
  CHECK(eventually([&] { return bench.safe(); }));
  CHECK(bench.trigger.arm(sequence()).error().code == ResultCode::kLinesLost);
}

TEST_CASE("START by the pin: a pulse, answered by BUSY or named as a broken wire", "[line trigger]") {
  Bench box;  // plays the microcontroller
  FakeGpio gpio;
  CellLines lines({.busy = line("busy"), .start = line("start")});
  REQUIRE(lines.open(gpio));
  lines.start();
  StartByLine trigger(box.trigger, lines);
  REQUIRE(eventually([&] { return trigger.inputs().belt_stopped; }));
  std::thread board([&] {
    if (eventually([&] { return gpio.wires["start"].writes == 2; })) gpio.wires["busy"].edge(true, monotonic_us());
  });
  CHECK(trigger.start_sequence(1));
  board.join();
  const auto unanswered = trigger.start_sequence(1);
  REQUIRE_FALSE(unanswered);
  CHECK(unanswered.error().code == ResultCode::kLinesLost);
  CHECK_THAT(unanswered.error().detail, Catch::Contains("BUSY"));
  box.gpio.wires["belt"].edge(false, monotonic_us());
  REQUIRE(eventually([&] { return !trigger.inputs().belt_stopped; }));
  CHECK(trigger.start_sequence(1).error().code == ResultCode::kBeltMovedDuringCapture);
  CHECK(gpio.wires["start"].writes == 4);
}
