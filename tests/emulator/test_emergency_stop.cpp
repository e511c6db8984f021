// The emergency stop at any cycle: outputs low within 10 us, no further pulse, the right fault, a way out. Each press
// is tried in a snapshot of the emulator, the serial line being under load.
#include <algorithm>
#include <cstdio>

#include "base/random.hpp"
#include "emulator/rig.hpp"
#include "emulator/snapshot.hpp"

using namespace emulator;
using protocol::Fault;
using protocol::Refusal;
using protocol::Type;

namespace {

constexpr std::uint64_t kLimit = 10 * kCyclesPerUs;
constexpr std::uint64_t kAhead = 8;  // cycles: longer than any instruction, so that a press comes at its very cycle

struct Broken {};

void demand(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "broken: %s\n", what);
  throw Broken();
}

bool is_pulse(const PinEdge& edge) { return edge.pin != Out::kFault && edge.pin != Out::kDone; }

// Presses at that cycle, for good or for 30 cycles; the cycles until the outputs were low, 0 where they were before.
std::uint64_t press(Rig& rig, std::uint64_t at, bool shortly) {
  rig.chip.at(at, [&rig] { rig.chip.set_pin(In::kEmergencyStop, true); });
  if (shortly) rig.chip.at(at + 30, [&rig] { rig.chip.set_pin(In::kEmergencyStop, false); });
  rig.chip.run_until(at);
  const std::size_t edges_before = rig.edges.size();
  rig.run_us(10);
  demand(rig.safe(), "outputs low within 10 us");
  std::uint64_t latest = 0;
  for (std::size_t i = edges_before; i < rig.edges.size(); ++i) {
    if (is_pulse(rig.edges[i]) && !rig.edges[i].level) latest = std::max(latest, rig.edges[i].cycle - at);
  }
  const std::size_t edges_after = rig.edges.size();
  rig.run_us(2500);  // beyond the next frame
  demand(std::none_of(rig.edges.begin() + static_cast<std::ptrdiff_t>(edges_after), rig.edges.end(),
                      [](const PinEdge& edge) { return is_pulse(edge) && edge.level; }),
         "no further pulse");
  demand(rig.chip.level(Out::kFault), "FAULT is high");
  demand(rig.status().fault == Fault::kEmergencyStop, "the fault is told");
  if (!shortly) {
    demand(rig.request(Type::kClear, protocol::Empty()) == Refusal::kEmergencyStopPressed,
           "CLEAR waits for the release");
  }
  rig.chip.set_pin(In::kEmergencyStop, false);
  rig.run_us(1500);
  demand(rig.request(Type::kClear, protocol::Empty()) == Refusal::kNone, "CLEAR ends the fault");
  demand(rig.status().state == protocol::State::kIdle, "idle");
  return latest;
}

class Trials {
 public:
  explicit Trials(Rig& rig) : rig_(rig), ask_at_(rig.chip.cycle()) {}

  // Of rising cycles.
  void press_at(std::uint64_t cycle) {
    run_up_to(cycle - kAhead);
    const bool shortly = ++trials_ % 3 == 0;
    const auto latest = in_snapshot([&] { return press(rig_, cycle, shortly); });
    INFO("pressed at cycle " << cycle << (shortly ? ", shortly" : ""));
    REQUIRE(latest);
    worst_ = std::max(worst_, *latest);
  }
  void report(const char* what) const {
    std::printf("emergency stop at %d %s: outputs low after at most %llu cycles\n", trials_, what,
                static_cast<unsigned long long>(worst_));
    CHECK(worst_ > 0);
    CHECK(worst_ <= kLimit);
  }

 private:
  // Asks for STATUS all the while.
  void run_up_to(std::uint64_t cycle) {
    while (rig_.chip.cycle() < cycle) {
      if (rig_.chip.cycle() >= ask_at_) {
        rig_.post(Type::kStatus, protocol::Empty());
        ask_at_ += 700 * kCyclesPerUs;
      }
      rig_.chip.run_until(std::min(cycle, ask_at_));
    }
  }

  Rig& rig_;
  std::uint64_t ask_at_;
  int trials_ = 0;
  std::uint64_t worst_ = 0;
};

// Starts a sequence and gives the cycle in which BUSY rose.
std::uint64_t start(Rig& rig, const protocol::Arm& arm) {
  REQUIRE(rig.request(Type::kArm, arm) == Refusal::kNone);
  rig.edges.clear();
  rig.post(Type::kStart, protocol::Start{arm.arm_id});
  while (!rig.chip.level(Out::kBusy)) rig.chip.run_until(rig.chip.cycle() + 16);
  return rig.edges.back().cycle;
}

// Two frames of 1.5 ms, pressed in every `stride`th cycle from START to behind the last edge.
void sweep_two_frames(std::uint64_t stride) {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  auto arm = sequence(1, 2);
  arm.groups[0] = {2, 300, 700, 1500, 700, 0};
  const std::uint64_t busy = start(rig, arm);
  Trials trials(rig);
  // The first frame begins 1 ms after BUSY, the last period ends 4 ms after it.
  for (std::uint64_t delay = 4 * kAhead; delay < 4000 * kCyclesPerUs; delay += stride) {
    trials.press_at(busy + delay);
  }
  trials.report("cycles of two frames");
}

// 128 frames of three exposures, 1.5 to 12 ms a frame, pressed at random instants.
void press_at_random(int instants, std::uint64_t seed) {
  Rig rig(GENERATE(Mcu::kAtmega2560, Mcu::kAtmega328p));
  auto arm = sequence(1, 128);
  arm.group_count = 3;
  arm.groups[0] = {60, 300, 700, 1500, 700, 0};
  arm.groups[1] = {48, 500, 2500, 4000, 1000, 0};
  arm.groups[2] = {20, 1000, 8000, 12000, 3000, 0};
  beltpick::Random random(seed);
  const std::uint64_t busy = start(rig, arm);
  std::vector<std::uint64_t> at;
  for (int i = 0; i < instants; ++i) at.push_back(busy + 4 * kAhead + random.below(523000 * kCyclesPerUs));
  std::sort(at.begin(), at.end());
  Trials trials(rig);
  for (const std::uint64_t cycle : at) trials.press_at(cycle);
  CHECK(rig.status().fault == Fault::kNone);
  trials.report("random instants of 128 frames");
}

}  // namespace

TEST_CASE("emergency stop in every 97th cycle of two frames: outputs low within 10 us, no further pulse",
          "[emulator]") {
  sweep_two_frames(97);
}

TEST_CASE("emergency stop at random instants of a long sequence: outputs low within 10 us, no further pulse",
          "[emulator]") {
  press_at_random(400, 11);
}

// Minutes: by hand, `test_emulator "[every-cycle]"`.
TEST_CASE("emergency stop in every cycle of two frames", "[.][every-cycle]") { sweep_two_frames(1); }

TEST_CASE("emergency stop at 10,000 random instants of a long sequence", "[.][every-cycle]") {
  press_at_random(10000, 12);
}
