// A bench for the sequencer, in microseconds: a clock that jumps from deadline to deadline, a camera that answers
// pulses with strobes, and a record of all output edges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/sequencer.hpp"

namespace bench {

using namespace beltpick;

inline constexpr std::uint8_t kStands = protocol::kInputBeltStopped;
inline constexpr std::uint8_t kMoves = 0;
inline constexpr std::uint8_t kStopPressed = protocol::kInputBeltStopped | protocol::kInputEmergencyStop;

inline protocol::Arm sequence(std::uint16_t arm_id, std::uint16_t frames) {
  protocol::Arm arm;
  arm.arm_id = arm_id;
  arm.host_silence_ms = 5000;
  arm.strobe_tolerance_us = 200;
  arm.group_count = 1;
  arm.groups[0].frames = frames;
  arm.groups[0].settle_us = 1000;
  arm.groups[0].exposure_us = 8000;
  arm.groups[0].period_us = 12500;
  arm.groups[0].readout_us = 4000;
  return arm;
}

struct Edge {
  char pin;  // p projector, c camera, b busy, d done, f fault
  bool level;
  std::uint32_t at_us;
  bool operator==(const Edge&) const = default;
};

class Bench {
 public:
  explicit Bench(std::uint8_t inputs = kStands, std::uint32_t start_us = 0)
      : now_us(start_us), sequencer(inputs, core::ticks_of(start_us)) {}

  // Strobe delays of the camera model; nullopt: no strobe.
  std::optional<std::uint32_t> strobe_rise_delay_us = 20;
  std::uint32_t strobe_fall_delay_us = 25;
  std::uint32_t now_us;
  core::Sequencer sequencer;
  std::vector<Edge> edges;

  // Lets time pass up to `until_us`, serving each deadline and strobe at its time.
  void run_to(std::uint32_t until_us) {
    while (true) {
      std::uint32_t next_us = until_us;
      std::uint32_t deadline_us = 0;
      if (next_deadline(deadline_us) && earlier(deadline_us, next_us)) next_us = deadline_us;
      const auto strobe = std::min_element(strobes_.begin(), strobes_.end(),
                                           [](const Edge& a, const Edge& b) { return earlier(a.at_us, b.at_us); });
      const bool strobe_first = strobe != strobes_.end() && !earlier(next_us, strobe->at_us);
      if (strobe_first) next_us = strobe->at_us;
      now_us = next_us;
      if (strobe_first) {
        const bool level = strobe->level;
        strobes_.erase(strobe);
        sequencer.on_strobe(level, now_ticks());
      } else {
        sequencer.on_time(now_ticks());
      }
      record();
      if (!strobe_first && now_us == until_us) return;
    }
  }
  void run_for(std::uint32_t span_us) { run_to(now_us + span_us); }

  protocol::Refusal start(std::uint16_t arm_id) {
    const auto refusal = sequencer.start(arm_id, now_ticks());
    record();
    return refusal;
  }
  void strobe(bool level) {
    sequencer.on_strobe(level, now_ticks());
    record();
  }
  void inputs(std::uint8_t levels) {
    sequencer.on_inputs(levels, now_ticks());
    record();
  }
  void arm_and_start(const protocol::Arm& arm) {
    sequencer.arm(arm);
    start(arm.arm_id);
  }
  protocol::StatusReport status() const { return sequencer.status(now_ticks()); }
  std::uint32_t now_ticks() const { return core::ticks_of(now_us); }
  void host_spoke() { sequencer.host_spoke(now_ticks()); }
  bool next_deadline(std::uint32_t& at_us) const {
    std::uint32_t at_ticks = 0;
    if (!sequencer.next_deadline(at_ticks)) return false;
    // Half the range of the ticks is all that they tell of a time.
    at_us = now_us + static_cast<std::uint32_t>(static_cast<std::int32_t>(at_ticks - now_ticks()) / 2);
    return true;
  }
  bool safe() const {
    const core::Outputs out = sequencer.outputs();
    return !out.projector && !out.camera && !out.busy;
  }
  template <class Event>
  std::vector<Event> events() {
    std::vector<Event> all;
    Event event;
    while (sequencer.take(event)) all.push_back(event);
    return all;
  }

 private:
  static bool earlier(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

  void record() {
    const core::Outputs out = sequencer.outputs();
    note('p', last_.projector, out.projector);
    note('c', last_.camera, out.camera);
    note('b', last_.busy, out.busy);
    note('d', last_.done, out.done);
    note('f', last_.fault, out.fault);
    if (out.camera != last_.camera && strobe_rise_delay_us) {
      strobes_.push_back({'s', out.camera, now_us + (out.camera ? *strobe_rise_delay_us : strobe_fall_delay_us)});
    }
    last_ = out;
  }
  void note(char pin, bool before, bool after) {
    if (before != after) edges.push_back({pin, after, now_us});
  }

  core::Outputs last_;
  std::vector<Edge> strobes_;
};

}  // namespace bench
