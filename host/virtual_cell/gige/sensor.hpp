// Sensor: when a trigger line makes an exposure. A pure state machine: edges in, exposures out; no clock of its own.
#pragma once

#include <cstdint>
#include <optional>

namespace beltpick::virtual_cell::gige {

struct Exposure {
  std::uint32_t trigger_number = 0;  // counts accepted triggers since the acquisition started, from 0
  std::int64_t start_us = 0;
  std::int64_t end_us = 0;  // 0 while open (TriggerWidth, pulse still on)

  [[nodiscard]] double duration_us() const { return static_cast<double>(end_us - start_us); }
};

struct SensorSettings {
  bool acquiring = false;
  bool line_triggered = false;  // TriggerMode On, TriggerSource Line0
  bool active_low = false;      // TriggerActivation FallingEdge
  bool trigger_width = false;   // ExposureMode TriggerWidth, else Timed
  double exposure_us = 0.0;     // of Timed
};

class Sensor {
 public:
  struct Event {
    bool started = false;  // an exposure began; of Timed it is complete already, with end_us in the future
    bool ended = false;    // the pulse ended the exposure (TriggerWidth)
    Exposure exposure;
  };

  // Starting or stopping the acquisition counts anew and drops an exposure whose pulse is still on: it is returned, so
  // that its strobe can end.
  std::optional<Exposure> configure(const SensorSettings& settings);

  // An edge of the trigger line. An active edge while an exposure runs is counted and otherwise ignored, as real
  // sensors do. Times do not decrease.
  std::optional<Event> edge(bool rising, std::int64_t time_us);

  [[nodiscard]] std::uint32_t edges_while_exposing() const { return edges_while_exposing_; }

 private:
  std::optional<Event> begin(std::int64_t time_us);

  SensorSettings settings_;
  std::optional<Exposure> current_;
  std::uint32_t next_trigger_ = 0;
  std::uint32_t edges_while_exposing_ = 0;
};

}  // namespace beltpick::virtual_cell::gige
