// The ripple that a projector's gamma makes with few steps is found in the capture and taken out, and nothing is
// "corrected" where there is none.
#include <catch2/catch.hpp>
#include <cstring>

#include "bench/quality/judge.hpp"
#include "contract/sequences.hpp"

namespace beltpick::testing {
namespace {

using bench::SceneChoice;

// A small rig, free of noise unless asked for: noise averages out of the ripple, but flicker and sway do not.
SceneChoice small_scene(SceneChoice::Kind kind, double gamma) {
  SceneChoice choice;
  choice.kind = kind;
  choice.parts = {"knuckle", "bracket"};
  choice.parts_in_view = 2;
  choice.rig.camera_width = 640;
  choice.rig.camera_height = 480;
  choice.render.projector_gamma = gamma;
  choice.render.noise = false;
  return choice;
}

Sequence steps_of(int steps, const ProjectorGrid& grid) {
  constexpr double kPeriodPx = 24.0;
  Sequence sequence{grid, {}, {}};
  for (int step = 0; step < steps; ++step) {
    FrameSpec& frame = sequence.frames.emplace_back();
    frame.kind = FrameKind::kPhase;
    frame.period_px = kPeriodPx;
    frame.steps = steps;
    frame.step = step;
    frame.offset_rad = 0.4;
  }
  for (int bit = 6; bit >= 0; --bit) {
    FrameSpec& frame = sequence.frames.emplace_back();
    frame.kind = FrameKind::kGray;
    frame.cell_px = 0.5 * kPeriodPx;
    frame.bit = bit;
  }
  return sequence;
}

struct Ripples {
  double corrected_px, uncorrected_px;
  bool same_bits;
};

Ripples measure(const SceneChoice& choice, int steps, std::uint64_t seed) {
  bench::VirtualCapture capture(choice);
  const Sequence sequence = steps_of(steps, capture.grid());
  capture.expose(sequence, seed);
  const auto truth = truth_of(capture);
  bench::Measurement measured = capture.measure(false);
  const double uncorrected_px = ripple_rms_px(capture, measured, truth, 24.0);
  const ImageView<float>& code = measured.code.column_px;
  const std::vector<float> before(code.data, code.data + code.size());
  measured = capture.measure();
  const bool same = std::memcmp(before.data(), measured.code.column_px.data, 4 * before.size()) == 0;
  return {ripple_rms_px(capture, measured, truth, 24.0), uncorrected_px, same};
}

TEST_CASE("the ripple of gamma 2.2 is cut to less than a fifth", "[ripple]") {
  const auto kind = GENERATE(SceneChoice::Kind::kPlane, SceneChoice::Kind::kParts);
  const int steps = GENERATE(3, 4);
  const Ripples ripples = measure(small_scene(kind, 2.2), steps, 12);
  INFO("steps " << steps << ": " << ripples.uncorrected_px << " px uncorrected, " << ripples.corrected_px << " px");
  CHECK(ripples.uncorrected_px > 0.015);
  CHECK(ripples.corrected_px < 0.2 * ripples.uncorrected_px);
}

TEST_CASE("a linear projector and many steps are left as they are", "[ripple]") {
  CHECK(measure(small_scene(SceneChoice::Kind::kParts, 1.0), 4, 13).same_bits);
  CHECK(measure(small_scene(SceneChoice::Kind::kPlane, 2.2), 8, 14).same_bits);
  SceneChoice noisy = small_scene(SceneChoice::Kind::kParts, 1.0);
  noisy.render.noise = true;
  CHECK(measure(noisy, 4, 15).same_bits);
}

}  // namespace
}  // namespace beltpick::testing
