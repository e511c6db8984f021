// The sensor's rules: which edges expose, which are ignored and counted.
#include <catch2/catch.hpp>

#include "virtual_cell/gige/sensor.hpp"

using beltpick::virtual_cell::gige::Sensor;
using beltpick::virtual_cell::gige::SensorSettings;

namespace {
Sensor armed(bool trigger_width) {
  Sensor sensor;
  SensorSettings settings;
  settings.acquiring = true;
  settings.line_triggered = true;
  settings.trigger_width = trigger_width;
  settings.exposure_us = 8000;
  sensor.configure(settings);
  return sensor;
}
}  // namespace

TEST_CASE("the pulse's width is the exposure") {
  Sensor sensor = armed(true);
  const auto begin = sensor.edge(true, 1000);
  REQUIRE(begin);
  CHECK(begin->started);
  CHECK(begin->exposure.end_us == 0);
  const auto end = sensor.edge(false, 4500);
  REQUIRE(end);
  CHECK(end->ended);
  CHECK(end->exposure.duration_us() == 3500);
}

TEST_CASE("a timed exposure ends by itself and swallows edges until then") {
  Sensor sensor = armed(false);
  const auto begin = sensor.edge(true, 1000);
  REQUIRE(begin);
  CHECK(begin->exposure.end_us == 9000);
  CHECK_FALSE(sensor.edge(false, 2000));
  CHECK_FALSE(sensor.edge(true, 8999));
  CHECK(sensor.edges_while_exposing() == 1);
  const auto next = sensor.edge(true, 9000);
  REQUIRE(next);
  CHECK(next->exposure.trigger_number == 1);
}

TEST_CASE("nothing is exposed before the acquisition starts, and counting begins anew with it") {
  Sensor sensor;
  CHECK_FALSE(sensor.edge(true, 1));
  sensor = armed(true);
  sensor.edge(true, 10);
  SensorSettings stopped;
  CHECK(sensor.configure(stopped));  // the pulse was still on
  SensorSettings again;
  again.acquiring = again.line_triggered = again.trigger_width = true;
  sensor.configure(again);
  CHECK_FALSE(sensor.edge(false, 20));  // the end of a pulse before
  const auto begin = sensor.edge(true, 30);
  REQUIRE(begin);
  CHECK(begin->exposure.trigger_number == 0);
}
