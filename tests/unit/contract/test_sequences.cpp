#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <map>

#include "base/units.hpp"
#include "contract/sequences.hpp"

using namespace beltpick;

namespace {

// The slow, obvious decoder: what a noiseless camera pixel that sees x would give.
double decode(const Sequence& sequence, Axis axis, double x) {
  std::complex<double> phasor = 0;
  double period = 0;
  double cell_px = 0;
  unsigned gray = 0;
  for (const FrameSpec& frame : sequence.frames) {
    if (frame.kind == FrameKind::kWhite || frame.kind == FrameKind::kBlack || frame.axis != axis) continue;
    const double intensity = pattern_intensity(frame, x);
    if (frame.kind == FrameKind::kPhase) {
      phasor += intensity * std::polar(1.0, -2 * kPi * frame.step / frame.steps);
      period = frame.period_px;
    } else if ((intensity > 0.5) != frame.inverted) {
      gray |= 1U << frame.bit;
    }
    if (frame.kind == FrameKind::kGray) cell_px = frame.cell_px;
  }
  unsigned cell = gray;
  for (unsigned shift = 1; shift < 32; shift *= 2) cell ^= cell >> shift;
  const double centre = (cell + 0.5) * cell_px - 0.5;
  const double fraction = std::arg(phasor) / (2 * kPi) * period;
  return fraction + period * std::round((centre - fraction) / period);
}

}  // namespace

TEST_CASE("A named sequence determines every pixel of any projector", "[sequences]") {
  const SequenceName name = GENERATE(SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust);
  const auto [width, height] = GENERATE(std::pair(912, 1140), std::pair(1024, 768), std::pair(1920, 1080),
                                        std::pair(3840, 2160), std::pair(608, 684), std::pair(37, 101));
  const auto sequence = make_sequence(name, {width, height, ProjectorLayout::kSquare}, SequenceAxes::kBoth);
  REQUIRE(sequence);
  double worst = 0;
  for (int x = 0; x < width; ++x) worst = std::max(worst, std::abs(decode(*sequence, Axis::kColumn, x) - x));
  for (int y = 0; y < height; ++y) worst = std::max(worst, std::abs(decode(*sequence, Axis::kRow, y) - y));
  CHECK(worst < 1e-9);
}

TEST_CASE("The frame budgets hold at 912 columns", "[sequences]") {
  const ProjectorGrid projector{912, 1140, ProjectorLayout::kSquare};
  CHECK(make_sequence(SequenceName::kFast, projector, SequenceAxes::kColumn)->frames.size() <= 12);
  CHECK(make_sequence(SequenceName::kStandard, projector, SequenceAxes::kColumn)->frames.size() <= 16);
  CHECK(make_sequence(SequenceName::kRobust, projector, SequenceAxes::kColumn)->frames.size() <= 32);
}

TEST_CASE("The fringe order survives a Gray code that stands two pixels off", "[sequences]") {
  const SequenceName name = GENERATE(SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust);
  const int width = GENERATE(228, 912, 1280, 1920, 3840);
  const auto sequence = make_sequence(name, {width, 1140, ProjectorLayout::kSquare}, SequenceAxes::kColumn);
  REQUIRE(sequence);
  double period_px = 0.0;
  double cell_px = 0.0;
  for (const FrameSpec& frame : sequence->frames) {
    if (frame.kind == FrameKind::kPhase) period_px = frame.period_px;
    if (frame.kind == FrameKind::kGray) cell_px = frame.cell_px;
  }
  CHECK((period_px - cell_px) / 2.0 >= 2.0);
  CHECK(period_px >= 10.0);
}

TEST_CASE("A threshold is known before the frame that needs it", "[sequences]") {
  const SequenceName name = GENERATE(SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust);
  const auto sequence = make_sequence(name, {912, 1140, ProjectorLayout::kSquare}, SequenceAxes::kBoth);
  REQUIRE(sequence);
  std::map<Axis, int> phases_left;
  for (const FrameSpec& frame : sequence->frames) phases_left[frame.axis] += frame.kind == FrameKind::kPhase;
  for (const FrameSpec& frame : sequence->frames) {
    if (frame.kind == FrameKind::kPhase) --phases_left[frame.axis];
    if (frame.kind == FrameKind::kGray) CHECK(phases_left[frame.axis] == 0);
  }
}

TEST_CASE("Files are numbered in projection order and axes are chosen", "[sequences]") {
  const ProjectorGrid projector{1024, 768, ProjectorLayout::kSquare};
  for (const auto& [axes, unwanted] :
       {std::pair(SequenceAxes::kColumn, Axis::kRow), std::pair(SequenceAxes::kRow, Axis::kColumn)}) {
    const auto sequence = make_sequence(SequenceName::kRobust, projector, axes);
    REQUIRE(sequence);
    CHECK(sequence->frames.front().file == "000.png");
    CHECK(sequence->frames[11].file == "011.png");
    for (const FrameSpec& frame : sequence->frames) {
      const bool coded = frame.kind == FrameKind::kPhase || frame.kind == FrameKind::kGray;
      CHECK_FALSE((coded && frame.axis == unwanted));
    }
  }
}

TEST_CASE("A projector too small for two periods is refused", "[sequences]") {
  const auto sequence =
      make_sequence(SequenceName::kStandard, {19, 600, ProjectorLayout::kSquare}, SequenceAxes::kColumn);
  REQUIRE_FALSE(sequence);
  CHECK(std::string(sequence.error().text()).find("found 19") != std::string::npos);
}

TEST_CASE("Pattern intensities follow the formulas of the design", "[sequences]") {
  FrameSpec phase;
  phase.kind = FrameKind::kPhase;
  phase.period_px = 18;
  phase.steps = 8;
  phase.step = 2;
  phase.offset_rad = 0.3;
  CHECK(pattern_intensity(phase, 7) == Approx(0.5 + 0.5 * std::cos(2 * kPi * 7 / 18 + 0.3 + 2 * kPi * 2 / 8)));
  FrameSpec gray;
  gray.kind = FrameKind::kGray;
  gray.cell_px = 9;
  gray.bit = 0;
  CHECK(pattern_intensity(gray, 8) == 0.0);   // cell 0: gray 0
  CHECK(pattern_intensity(gray, 9) == 1.0);   // cell 1: gray 1
  CHECK(pattern_intensity(gray, 18) == 1.0);  // cell 2: gray 3
  CHECK(pattern_intensity(gray, 27) == 0.0);  // cell 3: gray 2
  gray.inverted = true;
  CHECK(pattern_intensity(gray, 9) == 0.0);
}

TEST_CASE("A diamond lattice shifts its odd rows by half a pixel", "[sequences]") {
  CHECK(lattice_coordinate(ProjectorLayout::kSquare, Axis::kColumn, 3, 10) == 10.0);
  CHECK(lattice_coordinate(ProjectorLayout::kDiamond, Axis::kColumn, 3, 10) == 10.5);
  CHECK(lattice_coordinate(ProjectorLayout::kDiamond, Axis::kColumn, 4, 10) == 10.0);
  CHECK(lattice_coordinate(ProjectorLayout::kDiamond, Axis::kRow, 3, 10) == 3.0);
}
