// A concave shiny part, whose walls light each other: what that light spoils is masked, and the sequence of fine
// fringes alone spoils nothing.
#include <catch2/catch.hpp>

#include "bench/quality/judge.hpp"
#include "contract/sequences.hpp"

namespace beltpick::testing {
namespace {

bench::Tally tally_of(SequenceName name, bench::Tally& dry) {
  bench::Tally tallies[2];
  for (const double interreflection : {0.0, 1.0}) {
    bench::SceneChoice choice;
    choice.parts = {"vblock"};
    choice.parts_in_view = 2;
    choice.rig.camera_width = 640;
    choice.rig.camera_height = 480;
    choice.render.interreflection = interreflection;
    bench::VirtualCapture capture(choice);
    const auto sequence = make_sequence(name, capture.grid(), SequenceAxes::kColumn);
    REQUIRE(sequence);
    capture.expose(*sequence, 41);
    tallies[interreflection > 0.0 ? 1 : 0] = judge(capture, capture.measure(), truth_of(capture), 10.0);
  }
  dry = tallies[0];
  return tallies[1];
}

TEST_CASE("orders that bounced light turns over are masked", "[bounced]") {
  const SequenceName name = GENERATE(SequenceName::kRobust, SequenceName::kMicro);
  bench::Tally dry;
  const bench::Tally lit = tally_of(name, dry);
  CHECK(dry.part_points > 10'000);
  CHECK(dry.period_errors == 0);
  CHECK(static_cast<double>(lit.period_errors) <= 1e-4 * static_cast<double>(lit.part_points));
  CHECK(static_cast<double>(lit.complete) > 0.97 * static_cast<double>(dry.complete));
}

}  // namespace
}  // namespace beltpick::testing
