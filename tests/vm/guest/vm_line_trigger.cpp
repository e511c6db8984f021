// The trigger source on lines of the PC, against a simulated chip of the real kernel: a stand-in camera answers each
// pulse with its strobe; the kernel's own trace of the outputs counts and times the edges.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <thread>

#include "base/clock.hpp"
#include "base/thread_priority.hpp"
#include "capture/lines/line_trigger.hpp"
#include "contract/result_codes.hpp"
#include "gpio_sim.hpp"

using namespace beltpick;
using namespace beltpick::capture;

namespace {

enum Wire : unsigned { kBeltStopped, kEmergencyStop, kCamera, kProjector, kStrobe, kBusy, kFault, kWires };

template <class Condition>
bool eventually(Condition condition) {
  const std::int64_t until_us = monotonic_us() + 10'000'000;
  while (!condition()) {
    if (monotonic_us() > until_us) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

constexpr std::uint32_t kSettle_us = 20'000, kPeriod_us = 600'000;
constexpr std::uint32_t kExposure_us[2] = {100'000, 150'000};
constexpr std::int64_t kEarly_us = 500;  // the trace stamps an edge a little after its time

// Slow and tolerant: this machine is emulated, and shares its cores.
protocol::Arm two_exposures(std::uint16_t frames_each) {
  protocol::Arm arm;
  arm.host_silence_ms = 3000;
  arm.strobe_tolerance_us = 300'000;
  arm.group_count = 2;
  for (int i = 0; i < 2; ++i) arm.groups[i] = {frames_each, kSettle_us, kExposure_us[i], kPeriod_us, 50'000};
  return arm;
}

// The wired cell: what the strobe does is the stand-in camera's.
class Cell {
 public:
  Cell() : lines_(inputs()), trigger(outputs(), lines_) {
    sim.pull(kBeltStopped, true);
    for (const Result<void>& opened : {lines_.open(gpio_of_this_pc()), trigger.open(gpio_of_this_pc())}) {
      if (!opened) FAIL(opened.error().detail);
    }
    lines_.start();
    trigger.start();
    camera_ = std::thread([this] {
      make_realtime(RealtimePriority::kStream);
      for (bool exposing = false; !stopping_; std::this_thread::sleep_for(std::chrono::microseconds(200))) {
        const bool pulse = sim.level(kCamera);
        if (pulse == exposing) continue;
        exposing = pulse;
        if (!camera_dead || !exposing) sim.pull(kStrobe, exposing);
      }
    });
    REQUIRE(eventually([&] { return trigger.inputs().belt_stopped && !trigger.inputs().emergency_stop; }));
  }
  ~Cell() {
    stopping_ = true;
    camera_.join();
  }

  // Arms, starts, and waits for the end; kOk after DONE. `meanwhile` sees each frame's event.
  ResultCode run(const protocol::Arm& sequence,
                 const std::function<void(const protocol::FrameEvent&)>& meanwhile = {}) {
    const auto armed = trigger.arm(sequence);
    if (!armed) return armed.error().code;
    if (const auto started = trigger.start_sequence(*armed); !started) return started.error().code;
    ResultCode code = ResultCode::kCaptureTimeout;
    eventually([&] {
      const auto event = trigger.next_event();
      if (!event) return false;
      if (event->type == protocol::Type::kFrameEvent && meanwhile) meanwhile(event->frame);
      if (event->type == protocol::Type::kFaultEvent) code = code_of(event->fault.fault);
      if (event->type == protocol::Type::kDoneEvent) code = ResultCode::kOk;
      return event->type != protocol::Type::kFrameEvent;
    });
    return code;
  }
  [[nodiscard]] bool safe() const { return !sim.level(kCamera) && !sim.level(kProjector) && !sim.level(kBusy); }

  const vm::GpioSim sim{"proof", kWires};
  std::atomic<bool> camera_dead{false};

 private:
  [[nodiscard]] LineSpec line(Wire wire) const { return {sim.chip(), std::to_string(wire), false, LineBias::kAsIs}; }
  [[nodiscard]] CellLinesConfig inputs() const {
    CellLinesConfig config;
    config.belt_stopped = line(kBeltStopped);
    config.emergency_stop = line(kEmergencyStop);
    return config;
  }
  [[nodiscard]] LineTriggerConfig outputs() const {
    return {line(kCamera), line(kProjector), line(kStrobe), line(kBusy), line(kFault), 300'000};
  }

  CellLines lines_;
  std::atomic<bool> stopping_{false};
  std::thread camera_;

 public:
  LineTrigger trigger;
};

struct Pulse {
  std::int64_t at_us = 0, length_us = 0;
};
std::vector<Pulse> pulses_of(const std::vector<vm::TracedEdge>& edges, unsigned line) {
  std::vector<Pulse> pulses;
  for (const vm::TracedEdge& edge : edges) {
    if (edge.line != line) continue;
    if (edge.high) pulses.push_back({edge.at_us, 0});
    if (!edge.high && !pulses.empty()) pulses.back().length_us = edge.at_us - pulses.back().at_us;
  }
  return pulses;
}

}  // namespace

TEST_CASE("a whole sequence: each edge once, in order, by the kernel's own trace") {
  constexpr std::uint16_t kEach = 4;
  Cell cell;
  const vm::OutputTrace trace(cell.sim);
  std::vector<protocol::FrameEvent> frames;
  REQUIRE(cell.run(two_exposures(kEach), [&](const auto& frame) { frames.push_back(frame); }) == ResultCode::kOk);
  const auto edges = trace.read();
  const auto camera = pulses_of(edges, kCamera);
  const auto projector = pulses_of(edges, kProjector);
  const auto busy = pulses_of(edges, kBusy);

  REQUIRE(camera.size() == 2 * kEach);
  REQUIRE(projector.size() == 2 * kEach);
  REQUIRE(frames.size() == 2 * kEach);
  REQUIRE(busy.size() == 1);
  CHECK(busy[0].at_us < projector[0].at_us);
  CHECK(busy[0].at_us + busy[0].length_us > camera.back().at_us + camera.back().length_us);
  std::int64_t worst_exposure_us = 0, worst_period_us = 0;
  for (std::size_t i = 0; i < camera.size(); ++i) {
    CAPTURE(i);
    const std::int64_t exposure_us = kExposure_us[i / kEach];
    CHECK(frames[i].frame == i);
    CHECK(frames[i].trigger_number == i + 1);
    CHECK(camera[i].at_us - projector[i].at_us >= kSettle_us - kEarly_us);
    CHECK(camera[i].length_us >= exposure_us - kEarly_us);
    worst_exposure_us = std::max(worst_exposure_us, std::abs(camera[i].length_us - exposure_us));
    if (i == 0) continue;
    const std::int64_t period_us = projector[i].at_us - projector[i - 1].at_us;
    // Edges keep to the plan: after one that came late the next is nearer.
    CHECK(period_us >= kPeriod_us - kEarly_us - cell.trigger.worst_late_us());
    worst_period_us = std::max(worst_period_us, period_us - kPeriod_us);
  }
  WARN("in this emulated machine: exposures within " << worst_exposure_us << " us, periods within " << worst_period_us
                                                     << " us, latest edge " << cell.trigger.worst_late_us() << " us");
  CHECK(cell.safe());
}

TEST_CASE("what goes wrong has the microcontroller's names, leaves the outputs safe, and the next sequence runs") {
  Cell cell;
  const protocol::Arm sequence = two_exposures(1);
  SECTION("no strobe") {
    cell.camera_dead = true;
    CHECK(cell.run(sequence) == code_of(protocol::Fault::kStrobeMissing));
    CHECK(eventually([&] { return cell.safe() && cell.sim.level(kFault); }));
    cell.camera_dead = false;
  }
  SECTION("the belt moves") {
    CHECK(cell.run(sequence, [&](const auto&) { cell.sim.pull(kBeltStopped, false); }) ==
          ResultCode::kBeltMovedDuringCapture);
    CHECK(eventually([&] { return cell.safe() && cell.sim.level(kFault); }));
    cell.sim.pull(kBeltStopped, true);
  }
  SECTION("emergency stop") {
    CHECK(cell.run(sequence, [&](const auto&) { cell.sim.pull(kEmergencyStop, true); }) == ResultCode::kEmergencyStop);
    CHECK(eventually([&] { return cell.safe() && cell.sim.level(kFault); }));
    CHECK(cell.trigger.clear().error().code == ResultCode::kEmergencyStop);
    cell.sim.pull(kEmergencyStop, false);
  }
  SECTION("the appliance falls silent") {
    protocol::Arm silent = sequence;
    silent.host_silence_ms = 20;
    const auto id = cell.trigger.arm(silent);
    REQUIRE(id);
    REQUIRE(cell.trigger.start_sequence(*id));
    CHECK(eventually([&] { return cell.trigger.status().fault == protocol::Fault::kHostSilent; }));
    CHECK(cell.safe());
  }
  SECTION("it starts with the belt moving") {
    cell.sim.pull(kBeltStopped, false);
    REQUIRE(eventually([&] { return !cell.trigger.inputs().belt_stopped; }));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    CHECK(cell.run(sequence) == ResultCode::kBeltMovedDuringCapture);
    cell.sim.pull(kBeltStopped, true);
  }
  REQUIRE(eventually([&] { return cell.trigger.inputs().belt_stopped && !cell.trigger.inputs().emergency_stop; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  REQUIRE(cell.trigger.abort());
  REQUIRE(cell.trigger.clear());
  while (cell.trigger.next_event()) {
  }
  CHECK(cell.run(sequence) == ResultCode::kOk);
  CHECK(cell.safe());
}
