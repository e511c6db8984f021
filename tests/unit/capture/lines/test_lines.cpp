#include <catch2/catch.hpp>
#include <random>
#include <thread>

#include "base/clock.hpp"
#include "capture/lines/cell_lines.hpp"
#include "capture/lines/debounce.hpp"
#include "fake_gpio.hpp"

using namespace fake;

namespace {

template <class Condition>
bool eventually(Condition condition) {
  const std::int64_t until_us = monotonic_us() + 5'000'000;
  while (!condition()) {
    if (monotonic_us() > until_us) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

// Debounce by looking at every microsecond of the past: harmless only where the line was so for the whole hold time.
bool harmless_at(const std::vector<std::pair<std::int64_t, bool>>& edges, std::int64_t now_us, std::int64_t hold_us) {
  bool level = true;
  std::int64_t harmful_us = std::numeric_limits<std::int64_t>::min() / 2;
  for (const auto& [at_us, active] : edges) {
    if (at_us > now_us) break;
    if (!level && active) harmful_us = at_us;
    level = active;
  }
  return level && now_us - harmful_us >= hold_us;
}

}  // namespace

TEST_CASE("a line's text: chip, line, polarity, pull", "[lines]") {
  CHECK(parse_line_spec("", "gpiochip0").value() == LineSpec{});
  CHECK_FALSE(parse_line_spec("  ", "gpiochip0")->wired());
  CHECK(parse_line_spec("17", "gpiochip0").value() == LineSpec{"gpiochip0", "17", false, LineBias::kAsIs});
  CHECK(parse_line_spec("usb-dio:ESTOP active-low pull-up", "gpiochip0").value() ==
        LineSpec{"usb-dio", "ESTOP", true, LineBias::kPullUp});
  CHECK(parse_line_spec("4  pull-down", "c").value() == LineSpec{"c", "4", false, LineBias::kPullDown});
  CHECK(line_number(parse_line_spec("17", "c").value()) == 17U);
  CHECK_FALSE(line_number(parse_line_spec("GPIO17", "c").value()));
  CHECK_FALSE(line_number(parse_line_spec("17a", "c").value()));
  for (const char* wrong : {"4 low", "4 active-low pull-sideways", ":4", "chip:", "4 5"}) {
    CAPTURE(wrong);
    const auto parsed = parse_line_spec(wrong, "gpiochip0");
    REQUIRE_FALSE(parsed);
    CHECK(parsed.error().code == ResultCode::kValueOutOfRange);
  }
  CHECK_FALSE(parse_line_spec("4", ""));
}

TEST_CASE("harm counts with its first edge, harmlessness once it has lasted", "[lines]") {
  constexpr std::int64_t kHold_us = 1000;
  std::mt19937 random(7);
  std::vector<std::pair<std::int64_t, bool>> edges;
  Debounce belt(false, kHold_us, true);
  std::int64_t at_us = 10'000;
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::int64_t next_us = at_us + 1 + static_cast<std::int64_t>(random() % (i % 3 == 0 ? 4000 : 300));
    const bool active = random() % 2 == 0;  // also an edge to the level that it has
    belt.edge(active, at_us);
    edges.emplace_back(at_us, active);
    for (std::int64_t now_us = at_us; now_us < next_us; now_us += 97) {
      belt.advance(now_us);
      if (belt.active() != harmless_at(edges, now_us, kHold_us)) FAIL("at " << now_us << " us");
      if (const auto due_us = belt.due_us()) CHECK(*due_us > now_us);
      ++compared;
    }
    at_us = next_us;
  }
  CHECK(compared > 20000);
}

TEST_CASE("without a debounce time every edge counts at once", "[lines]") {
  Debounce busy(false, 0, false);
  busy.edge(true, 5);
  CHECK(busy.active());
  busy.edge(false, 6);
  CHECK_FALSE(busy.active());
  CHECK_FALSE(busy.due_us());
}

TEST_CASE("each line is what it is wired as; what is not wired is harmless", "[lines]") {
  FakeGpio gpio;
  CellLinesConfig config;
  SECTION("none") {
    CellLines lines(config);
    REQUIRE(lines.open(gpio));
    lines.start();
    const CellInputs inputs = lines.inputs();
    CHECK((inputs.known && inputs.belt_stopped && !inputs.emergency_stop && !inputs.fault));
    CHECK(lines.show().empty());
    lines.permit_belt(true);
  }
  SECTION("all") {
    config = {line("belt"), line("stop"), line("busy"), line("fault"), line("move"), line("start"), 0};
    CellLines lines(config);
    REQUIRE(lines.open(gpio));
    lines.start();
    CHECK_FALSE(lines.inputs().belt_stopped);
    const std::int64_t now_us = monotonic_us();
    gpio.wires["belt"].edge(true, now_us);
    CHECK(eventually([&] { return lines.inputs().belt_stopped; }));
    CHECK(lines.inputs().changed_us == now_us);
    gpio.wires["stop"].edge(true, now_us);
    CHECK(eventually([&] { return lines.inputs().emergency_stop; }));
    gpio.wires["busy"].edge(true, now_us);
    gpio.wires["busy"].edge(false, now_us + 1);
    CHECK(eventually([&] { return lines.inputs().busy_rises == 1 && !lines.inputs().busy; }));
    gpio.wires["fault"].edge(true, now_us);
    CHECK(eventually([&] { return lines.inputs().fault; }));
    REQUIRE(lines.pulse_start());
    CHECK(gpio.wires["start"].writes == 2);
    CHECK_FALSE(gpio.wires["start"].level());
    CHECK(lines.show().size() == 6);
  }
  for (const auto& [name, wire] : gpio.wires) CHECK(wire.holders == 0);
}

TEST_CASE("an edge that was lost is found by looking again", "[lines]") {
  FakeGpio gpio;
  CellLinesConfig config;
  config.emergency_stop = line("stop");
  CellLines lines(config);
  REQUIRE(lines.open(gpio));
  lines.start();
  {
    const std::lock_guard lock(gpio.wires["stop"].mutex);
    gpio.wires["stop"].active = true;
  }
  CHECK(eventually([&] { return lines.inputs().emergency_stop; }));
}

TEST_CASE("the permission needs the register's bit and no stop, no fault, no lost line", "[lines]") {
  FakeGpio gpio;
  CellLinesConfig config;
  config.emergency_stop = line("stop");
  config.fault = line("fault");
  config.belt_may_move = line("move");
  config.debounce_ms = 0;
  {
    CellLines lines(config);
    REQUIRE(lines.open(gpio));
    lines.start();
    const auto moves = [&] { return gpio.wires["move"].level(); };
    CHECK_FALSE(moves());
    lines.permit_belt(true);
    CHECK(moves());
    lines.permit_belt(true);
    CHECK(gpio.wires["move"].writes == 1);
    for (const char* stop : {"stop", "fault"}) {
      gpio.wires[stop].edge(true, monotonic_us());
      CHECK(eventually([&] { return !moves(); }));
      gpio.wires[stop].edge(false, monotonic_us());
      CHECK(eventually(moves));
    }
    lines.permit_belt(false);
    CHECK_FALSE(moves());
    lines.permit_belt(true);
    gpio.wires["stop"].take_away();
    CHECK(eventually([&] { return !moves(); }));
    const CellInputs inputs = lines.inputs();
    CHECK((!inputs.known && !inputs.belt_stopped && inputs.emergency_stop && inputs.fault));
    CHECK(lines.last_error().code == ResultCode::kLinesLost);
  }
  {
    CellLines lines({.belt_may_move = line("move")});
    REQUIRE(lines.open(gpio));
    lines.permit_belt(true);
    CHECK(gpio.wires["move"].level());
  }
  CHECK_FALSE(gpio.wires["move"].level());
}

TEST_CASE("one line that cannot be had is the error of all", "[lines]") {
  FakeGpio gpio;
  CellLines lines({.belt_stopped = line("belt"), .start = line("missing")});
  const auto opened = lines.open(gpio);
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ResultCode::kLineNotFound);
  CHECK_THAT(opened.error().detail, Catch::Contains("lines.start"));
}
