#include "virtual_cell/gige/sensor.hpp"

#include <cmath>

namespace beltpick::virtual_cell::gige {

std::optional<Exposure> Sensor::configure(const SensorSettings& settings) {
  std::optional<Exposure> dropped;
  if (settings.acquiring != settings_.acquiring) {
    if (current_ && current_->end_us == 0) dropped = current_;
    next_trigger_ = 0;
    current_.reset();
  }
  settings_ = settings;
  return dropped;
}

std::optional<Sensor::Event> Sensor::edge(bool rising, std::int64_t time_us) {
  if (!settings_.acquiring || !settings_.line_triggered) return std::nullopt;
  if (rising != settings_.active_low) return begin(time_us);
  if (!settings_.trigger_width || !current_ || current_->end_us != 0) return std::nullopt;
  current_->end_us = time_us;
  return Event{false, true, *current_};
}

std::optional<Sensor::Event> Sensor::begin(std::int64_t time_us) {
  if (current_ && (current_->end_us == 0 || time_us < current_->end_us)) {
    ++edges_while_exposing_;
    return std::nullopt;
  }
  current_ = Exposure{next_trigger_++, time_us, 0};
  if (!settings_.trigger_width) current_->end_us = time_us + std::llround(settings_.exposure_us);
  return Event{true, false, *current_};
}

}  // namespace beltpick::virtual_cell::gige
