// What comes out of a wire that sticks or loses a pulse, and when it is mended.
#include <catch2/catch.hpp>
#include <vector>

#include "virtual_cell/world/wire.hpp"

using beltpick::virtual_cell::Wire;

namespace {

struct Bench {
  std::vector<bool> far;
  Wire wire{[this](bool level, std::int64_t) { far.push_back(level); }};

  void pulses(int count) {
    for (int i = 0; i < count; ++i) {
      wire.drive(true, 2 * i);
      wire.drive(false, 2 * i + 1);
    }
  }
};

}  // namespace

TEST_CASE("a whole wire passes every edge once", "[wire]") {
  Bench bench;
  bench.pulses(2);
  bench.wire.drive(false, 9);
  CHECK(bench.far == std::vector<bool>{true, false, true, false});
}

TEST_CASE("a wire stuck low passes nothing, and all again once it is mended", "[wire]") {
  Bench bench;
  bench.wire.stick_at(false);
  bench.pulses(3);
  CHECK(bench.far.empty());
  bench.wire.drive(true, 7);
  bench.wire.mend();
  CHECK(bench.far == std::vector<bool>{true});
  bench.wire.drive(false, 8);
  CHECK(bench.far == std::vector<bool>{true, false});
}

TEST_CASE("a wire that sticks high takes its next rise and keeps it until it is mended", "[wire]") {
  Bench bench;
  bench.wire.stick_at(true);
  CHECK(bench.far.empty());
  bench.pulses(2);
  CHECK(bench.far == std::vector<bool>{true});
  bench.wire.mend();
  CHECK(bench.far == std::vector<bool>{true, false});
}

TEST_CASE("one pulse is lost, the one asked for", "[wire]") {
  Bench bench;
  bench.wire.lose_pulse(1);
  bench.pulses(1);
  CHECK(bench.far.size() == 2);
  bench.pulses(1);
  CHECK(bench.far.size() == 2);
  bench.pulses(1);
  CHECK(bench.far.size() == 4);
}
