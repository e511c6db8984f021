// How well this PC keeps the time of camera pulses when its own lines drive them (capture/lines/line_trigger.hpp),
// without the lines: what the scheduler does to the thread. A real line adds what its chip takes, from a microsecond
// to, behind USB or I2C, milliseconds.
//   bench_line_trigger [SEQUENCES]      default 20, of 22 frames of 8 ms each 25 ms
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include "base/thread_priority.hpp"
#include "capture/lines/line_trigger.hpp"
#include "unit/capture/lines/fake_gpio.hpp"

using namespace fake;

namespace {

constexpr std::uint16_t kFrames = 22;
constexpr std::int64_t kExposure_us = 8000, kPeriod_us = 25'000;

protocol::Arm sequence() {
  protocol::Arm arm;
  arm.host_silence_ms = 1000;
  arm.strobe_tolerance_us = 10'000;
  arm.group_count = 1;
  arm.groups[0] = {kFrames, 1000, kExposure_us, kPeriod_us, 12'000, 0};
  return arm;
}

bool run(LineTrigger& trigger) {
  const auto armed = trigger.arm(sequence());
  if (!armed || !trigger.start_sequence(*armed)) return false;
  for (;;) {
    const auto event = trigger.next_event();
    if (event && event->type == protocol::Type::kDoneEvent) return true;
    if (event && event->type == protocol::Type::kFaultEvent) return false;
    if (!event) std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
}

// From the emergency stop's edge to the camera's line being inactive, at instants within an exposure.
std::vector<std::int64_t> time_stops(EchoGpio& gpio, LineTrigger& trigger, int count) {
  std::vector<std::int64_t> stops_us;
  std::mt19937 random(1);
  std::atomic<std::int64_t> risen_us{0}, fallen_us{0};
  gpio.on_pulse = [&](const LineEdge& edge) { (edge.active ? risen_us : fallen_us) = edge.at_us; };
  while (static_cast<int>(stops_us.size()) < count) {
    risen_us = fallen_us = 0;
    const auto armed = trigger.arm(sequence());
    if (!armed || !trigger.start_sequence(*armed)) break;
    while (risen_us == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 4000));
    const std::int64_t pressed_us = monotonic_us();
    gpio.wires["stop"].edge(true, pressed_us);
    while (fallen_us == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
    stops_us.push_back(fallen_us - pressed_us);
    gpio.wires["stop"].edge(false, monotonic_us());
    while (!trigger.clear()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return stops_us;
}

void print(const char* what, std::vector<std::int64_t> deviations_us) {
  std::ranges::sort(deviations_us);
  const auto at = [&](double share) {
    return static_cast<long long>(
        deviations_us[static_cast<std::size_t>(share * static_cast<double>(deviations_us.size() - 1))]);
  };
  std::printf("%-22s %8zu %8lld %8lld %8lld %8lld\n", what, deviations_us.size(), at(0), at(0.5), at(0.99), at(1));
}

}  // namespace

int main(int argc, char** argv) {
  const int sequences = argc > 1 ? std::atoi(argv[1]) : 20;
  EchoGpio gpio;
  gpio.wires["belt"].active = true;
  std::vector<std::int64_t> exposures_us, periods_us;
  std::int64_t rise_us = 0;
  gpio.on_pulse = [&](const LineEdge& edge) {
    if (!edge.active) return exposures_us.push_back(edge.at_us - rise_us - kExposure_us);
    if (rise_us != 0 && edge.at_us - rise_us < 2 * kPeriod_us) periods_us.push_back(edge.at_us - rise_us - kPeriod_us);
    rise_us = edge.at_us;
  };
  CellLines lines({.belt_stopped = line("belt"), .emergency_stop = line("stop"), .debounce_ms = 0});
  LineTrigger trigger({line("camera"), line("projector"), line("strobe"), {}, {}, 10'000}, lines);
  if (!lines.open(gpio) || !trigger.open(gpio)) return 1;
  lines.start();
  trigger.start();
  int failed = 0;
  for (int i = 0; i < sequences; ++i) {
    rise_us = 0;
    if (run(trigger)) continue;
    ++failed;
    static_cast<void>(trigger.clear());
  }
  const std::vector<std::int64_t> stops_us = time_stops(gpio, trigger, 10 * sequences);
  std::printf("%s priority; %d sequences, %d of them failed; deviations in us\n",
              RealtimeSection(RealtimePriority::kTrigger).is_realtime() ? "real-time" : "ordinary", sequences, failed);
  std::printf("%-22s %8s %8s %8s %8s %8s\n", "", "count", "least", "median", "99 %", "most");
  print("exposure - 8000", exposures_us);
  print("period - 25000", periods_us);
  print("stop to camera off", stops_us);
}
