// The GPIO functions and the cell's lines on a simulated chip of the real kernel.
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <thread>

#include "base/clock.hpp"
#include "capture/lines/cell_lines.hpp"
#include "contract/result_codes.hpp"
#include "gpio_sim.hpp"

using namespace beltpick;
using namespace beltpick::capture;
using vm::GpioSim;

namespace {

void sleep_ms(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

template <class Condition>
bool eventually(Condition condition) {
  const std::int64_t until_us = monotonic_us() + 10'000'000;
  while (!condition()) {
    if (monotonic_us() > until_us) return false;
    sleep_ms(1);
  }
  return true;
}

LineSpec line(const GpioSim& sim, const std::string& text) { return parse_line_spec(text, sim.chip()).value(); }

std::unique_ptr<GpioLine> take(const LineSpec& spec, LineUse use) {
  auto taken = gpio_of_this_pc().request(spec, use, "proof");
  if (!taken) FAIL(taken.error().detail);
  return std::move(*taken);
}

// What the request of a line is refused with.
Error refused(const LineSpec& spec) {
  auto taken = gpio_of_this_pc().request(spec, LineUse::kInput, "belt_stopped");
  if (taken) FAIL("the line was granted");
  return taken.error();
}

}  // namespace

TEST_CASE("libgpiod is the version that this program was built for") {
  INFO(gpio_library_version());
  CHECK(gpio_library_version()[0] == VM_GPIOD_VERSION);
}

TEST_CASE("every line in both directions, both polarities, with edges stamped by the kernel") {
  const GpioSim sim("proof", 12);
  const bool active_low = GENERATE(false, true);
  for (unsigned i = 0; i < 12; ++i) {
    CAPTURE(i, active_low);
    const LineSpec spec = line(sim, std::to_string(i) + (active_low ? " active-low" : ""));
    {
      sim.pull(i, active_low);
      const auto input = take(spec, LineUse::kInput);
      CHECK_FALSE(input->read().value());
      CHECK_FALSE(input->next_edge().value());
      for (const bool active : {true, false}) {
        const std::int64_t before_us = monotonic_us();
        sim.pull(i, active != active_low);
        std::optional<LineEdge> edge;
        REQUIRE(eventually([&] { return (edge = input->next_edge().value()).has_value(); }));
        CHECK(edge->active == active);
        CHECK(edge->at_us >= before_us);
        CHECK(edge->at_us <= monotonic_us());
        CHECK(input->read().value() == active);
      }
      CHECK_FALSE(input->next_edge().value());
    }
    const auto output = take(spec, LineUse::kOutput);
    CHECK(sim.level(i) == active_low);
    for (const bool active : {true, false, true}) {
      REQUIRE(output->write(active));
      CHECK(sim.level(i) == (active != active_low));
    }
  }
}

TEST_CASE("a pull asked for is set") {
  const GpioSim sim("proof", 2);
  const auto up = take(line(sim, "0 pull-up"), LineUse::kInput);
  const auto down = take(line(sim, "1 pull-down"), LineUse::kInput);
  CHECK(up->read().value());
  CHECK_FALSE(down->read().value());
}

TEST_CASE("lines and chips go by name, too") {
  const GpioSim sim("proof", 4, {{2, "BELT_STOPPED"}});
  sim.pull(2, true);
  for (const std::string& chip : {std::string("proof"), sim.chip(), "/dev/" + sim.chip()}) {
    CAPTURE(chip);
    const auto by_name = take(parse_line_spec(chip + ":BELT_STOPPED", "").value(), LineUse::kInput);
    CHECK(by_name->read().value());
  }
}

TEST_CASE("what is not there is named") {
  const GpioSim sim("proof", 4);
  const Error chip = refused({"gpiochip77", "1"});
  CHECK(chip.code == ResultCode::kLineNotFound);
  CHECK_THAT(chip.detail, Catch::Contains("lines.belt_stopped") && Catch::Contains("gpiochip77"));
  for (const char* missing : {"4", "NO_SUCH_NAME"}) {
    const Error error = refused(line(sim, missing));
    CHECK(error.code == ResultCode::kLineNotFound);
    CHECK_THAT(error.detail, Catch::Contains(missing) && Catch::Contains("0 to 3"));
  }
}

TEST_CASE("who holds a busy line is named: another program, or the kernel") {
  const GpioSim sim("proof", 4, {}, 3);
  const std::string monitor = "gpiomon " + sim.chip() + " 1 >/dev/null & echo $!";
  FILE* started = ::popen(monitor.c_str(), "r");
  int pid = 0;
  REQUIRE(std::fscanf(started, "%d", &pid) == 1);
  ::pclose(started);
  REQUIRE(eventually([] { return std::system("gpioinfo | grep -q gpiomon") == 0; }));
  const Error error = refused(line(sim, "1"));
  CHECK(error.code == ResultCode::kLineInUse);
  CHECK_THAT(error.detail, Catch::Contains("held by 'gpiomon'"));
  ::kill(pid, SIGTERM);
  CHECK(eventually(
      [&] { return gpio_of_this_pc().request(line(sim, "1"), LineUse::kInput, "belt_stopped").has_value(); }));

  const Error hogged = refused(line(sim, "3"));
  CHECK(hogged.code == ResultCode::kLineInUse);
  CHECK_THAT(hogged.detail, Catch::Contains("held by 'kernel hog'"));
}

TEST_CASE("1000 of 1000 edges arrive, in order, with rising stamps") {
  constexpr int kEdges = 1000;
  const GpioSim sim("proof", 1);
  const auto input = take(line(sim, "0"), LineUse::kInput);
  std::atomic<int> count{0};
  std::atomic<bool> given_up{false};
  // The kernel's interrupt thread tells an edge by the level it finds: one that is faster than it is lost to any
  // reader.
  std::thread hand([&] {
    for (int i = 0; i < kEdges && !given_up; ++i) {
      const std::int64_t begin_us = monotonic_us();
      sim.pull(0, i % 2 == 0);
      while (monotonic_us() - begin_us < 200 || (count <= i && !given_up)) std::this_thread::yield();
    }
  });
  bool alternate = true;
  std::int64_t first_us = 0, last_us = 0;
  const std::int64_t until_us = monotonic_us() + 20'000'000;
  while (count < kEdges && monotonic_us() < until_us) {
    pollfd wait{input->edge_fd(), POLLIN, 0};
    ::poll(&wait, 1, 10);
    while (const auto edge = input->next_edge().value()) {
      alternate = alternate && edge->active == (count % 2 == 0) && edge->at_us > last_us;
      last_us = edge->at_us;
      if (count == 0) first_us = last_us;
      ++count;
    }
  }
  given_up = true;
  hand.join();
  CHECK(count == kEdges);
  CHECK(alternate);
  WARN(count << " edges at " << 1e6 * (count - 1) / static_cast<double>(last_us - first_us) << " per second");
}

TEST_CASE("the permission falls with emergency stop, FAULT, the end of the process and its crash") {
  const GpioSim sim("proof", 6);
  CellLinesConfig config;
  config.belt_stopped = line(sim, "0");
  config.emergency_stop = line(sim, "1");
  config.fault = line(sim, "2");
  config.belt_may_move = line(sim, "3");
  sim.pull(3, false);
  SECTION("interlocks") {
    CellLines lines(config);
    REQUIRE(lines.open(gpio_of_this_pc()));
    lines.start();
    CHECK_FALSE(sim.level(3));
    REQUIRE(eventually([&] { return !lines.inputs().emergency_stop; }));
    for (const unsigned stop : {1U, 2U}) {
      lines.permit_belt(true);
      CHECK(sim.level(3));
      sim.pull(stop, true);
      CHECK(eventually([&] { return !sim.level(3); }));
      sim.pull(stop, false);
      CHECK(eventually([&] { return sim.level(3); }));
    }
    lines.permit_belt(false);
    CHECK_FALSE(sim.level(3));
    lines.permit_belt(true);
  }
  SECTION("crash") {
    const pid_t child = ::fork();
    if (child == 0) {
      CellLines lines(config);
      if (!lines.open(gpio_of_this_pc())) ::_exit(1);
      lines.start();
      for (;;) {
        lines.permit_belt(true);
        sleep_ms(5);
      }
    }
    CHECK(eventually([&] { return sim.level(3); }));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  CHECK(eventually([&] { return !sim.level(3); }));
}
