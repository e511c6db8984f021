// The decoder against a slow oracle and against the truth, over the kinds of sequence that a capture may have.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <vector>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "unit/decode/oracle.hpp"
#include "unit/decode/synthetic.hpp"

namespace beltpick::testing {
namespace {

struct Case {
  const char* name;
  ProjectorGrid projector;
  std::function<void(Sequence&)> fill;
  double tolerance_px;  // of a valid pixel against the truth
  double least_valid;   // share of the pixels whose fringe stands out of the noise
  // Cells as wide as the period leave both borders of a cell alike: the decoder mends what the oracle gets wrong, but
  // where noise alone makes a bit look like a border it can err.
  bool safe_borders = true;
};

void white_black(Sequence& s) {
  s.frames.push_back(plain_frame(FrameKind::kWhite));
  s.frames.push_back(plain_frame(FrameKind::kBlack));
}

const std::vector<Case>& cases() {
  constexpr Axis kC = Axis::kColumn;
  constexpr Axis kR = Axis::kRow;
  static const std::vector<Case> all = {
      {"design example: references last",
       {912, 1140},
       [](Sequence& s) {
         add_phases(s, kC, 18, 8);
         add_gray(s, kC, 9);
         white_black(s);
       },
       2.0,
       0.98},
      {"references first",
       {912, 1140},
       [](Sequence& s) {
         white_black(s);
         add_gray(s, kC, 9);
         add_phases(s, kC, 18, 8);
       },
       2.0,
       0.98},
      {"Gray before the phase that is its threshold",
       {912, 1140},
       [](Sequence& s) {
         add_gray(s, kC, 9);
         add_phases(s, kC, 18, 8);
       },
       2.0,
       0.98},
      {"threshold from the other axis",
       {640, 480},
       [](Sequence& s) {
         add_phases(s, kC, 16, 6);
         add_gray(s, kC, 8);
         add_gray(s, kR, 4);
       },
       4.0,
       0.9},
      {"row axis, fractional period, three steps",
       {800, 600},
       [](Sequence& s) {
         add_phases(s, kR, 17.3, 3);
         add_gray(s, kR, 8.65);
       },
       3.0,
       0.97},
      {"sixteen steps, an offset, missing low bits",
       {1920, 1080},
       [](Sequence& s) {
         add_phases(s, kC, 32, 16, 0.7);
         add_gray(s, kC, 2, 3, true);
       },
       2.0,
       0.98},
      {"both axes, twins",
       {912, 1140},
       [](Sequence& s) {
         for (const Axis a : {kC, kR}) {
           add_phases(s, a, 20, 5);
           add_gray(s, a, 10, 0, true);
         }
       },
       3.0,
       0.97},
      {"all twins after all upright frames",
       {1024, 768},
       [](Sequence& s) {
         add_gray(s, kC, 1);
         const auto upright = s.frames;
         for (FrameSpec f : upright) {
           f.inverted = true;
           s.frames.push_back(f);
         }
       },
       1.01,
       0.9},
      {"inverted frames alone",
       {1024, 768},
       [](Sequence& s) {
         white_black(s);
         add_gray(s, kC, 4);
         for (FrameSpec& f : s.frames) f.inverted = f.kind == FrameKind::kGray;
       },
       4.01,
       0.95},
      {"cell as wide as the period",
       {912, 1140},
       [](Sequence& s) {
         add_phases(s, kC, 16, 8);
         add_gray(s, kC, 16);
         white_black(s);
       },
       2.0,
       0.95,
       false},
      {"hierarchical periods",
       {912, 1140},
       [](Sequence& s) {
         add_phases(s, kC, 16, 8);
         add_phases(s, kC, 120, 8);
         add_phases(s, kC, 960, 8);
       },
       2.0,
       0.8},
      {"heterodyne periods",
       {912, 1140},
       [](Sequence& s) {
         add_phases(s, kC, 18, 6);
         add_phases(s, kC, 20.5, 6);
         add_phases(s, kC, 23, 6);
       },
       2.0,
       0.8},
      {"wide Gray cells and two periods",
       {912, 1140},
       [](Sequence& s) {
         add_phases(s, kC, 16, 8);
         add_phases(s, kC, 20, 8);
         add_gray(s, kC, 57, 0, true);
       },
       2.0,
       0.9},
  };
  return all;
}

Sequence sequence_of(const Case& c) {
  Sequence sequence;
  sequence.projector = c.projector;
  c.fill(sequence);
  return sequence;
}

// Wrong by more than a fraction of a period: must not happen to pixels called valid.
struct Score {
  int measurable = 0, valid = 0, wrong = 0, differs = 0;
};

Score compare(const Case& c, Axis axis, const CodeImage& code, const Scene& scene, const Images& images,
              const Sequence& sequence) {
  const ImageView<float> x = axis == Axis::kColumn ? code.column_px : code.row_px;
  const auto& truth = axis == Axis::kColumn ? scene.column_px : scene.row_px;
  Score score;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool measurable = scene.gain[i] > 40.0;
    score.measurable += measurable;
    const float found = x.data[i];
    if (std::isnan(found)) continue;
    score.valid += measurable;
    score.wrong += std::abs(found - truth[i]) > c.tolerance_px;
    if (i % 7 == 0) score.differs += std::abs(found - oracle_coordinate(sequence, images, axis, i)) > 0.02;
    if (found < -0.5F || !(found < static_cast<float>(sequence.projector.extent(axis)) - 0.5F)) ++score.wrong;
  }
  return score;
}

void check_case(const Case& c, const Imaging& imaging) {
  INFO(c.name << ", " << imaging.bits << " bits");
  const Sequence sequence = sequence_of(c);
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  const Scene scene = make_scene(c.projector, 24, 160, 7);
  const Images images = image_sequence(sequence, scene, imaging);
  OwnDecoder decoder(*plan, images.rows, images.cols, imaging.bits / 8);
  const auto code = decode_images(decoder, *plan, images, imaging);
  if (!code) FAIL(code.error().detail);
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    if (!plan->codes(axis)) continue;
    const Score score = compare(c, axis, *code, scene, images, sequence);
    INFO("axis " << static_cast<int>(axis) << ": valid " << score.valid << " of " << score.measurable << ", wrong "
                 << score.wrong << ", other than the oracle " << score.differs);
    CHECK(score.valid >= c.least_valid * score.measurable);
    CHECK(score.wrong <= (c.safe_borders ? 0 : 3));
    CHECK((score.differs == 0 || !c.safe_borders));
  }
}

TEST_CASE("every kind of sequence decodes as the oracle does, and to the truth") {
  for (const Case& c : cases()) {
    check_case(c, {.bits = 8});
    check_case(c, {.full_scale = 4095, .bits = 16});
  }
}

TEST_CASE("blur at the borders of Gray cells costs no fringe order") {
  for (const Case& c : cases()) check_case(c, {.blur_px = 1.5, .seed = 3});
}

TEST_CASE("the named sequences take at most 16 bytes a pixel and an axis") {
  for (const auto name : {SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust}) {
    const auto sequence = make_sequence(name, {912, 1140}, SequenceAxes::kColumn);
    REQUIRE(sequence);
    const auto plan = decode::make_fold_plan(*sequence);
    REQUIRE(plan);
    CHECK(plan->state_bytes(1) <= 16);
  }
  const auto plan = decode::make_fold_plan(sequence_of(cases().front()));
  REQUIRE(plan);
  CHECK(plan->state_bytes(1) <= 16);
}

TEST_CASE("an HDR capture takes each pixel from the exposure that measured it best") {
  Sequence sequence;
  sequence.projector = {912, 1140};
  for (const double exposure_us : {4000.0, 500.0}) {
    const std::size_t first = sequence.frames.size();
    add_phases(sequence, Axis::kColumn, 18, 8);
    add_gray(sequence, Axis::kColumn, 9);
    white_black(sequence);
    for (std::size_t i = first; i < sequence.frames.size(); ++i) sequence.frames[i].exposure_us = exposure_us;
  }
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  CHECK(plan->exposures.size() == 2);
  const Scene scene = make_scene(sequence.projector, 24, 160, 11);
  const Images images = image_sequence(sequence, scene, {});
  OwnDecoder decoder(*plan, images.rows, images.cols, 1);
  const auto code = decode_images(decoder, *plan, images, {});
  REQUIRE(code);
  int bright = 0, bright_valid = 0, dark = 0, dark_valid = 0, wrong = 0;
  for (std::size_t i = 0; i < scene.gain.size(); ++i) {
    const bool valid = code->state.data[i] == PixelState::kValid;
    if (valid) wrong += std::abs(code->column_px.data[i] - scene.column_px[i]) > 2.0;
    if (scene.gain[i] > 80.0) ++bright, bright_valid += valid;                      // saturates at 4000 us
    if (scene.gain[i] > 10.0 && scene.gain[i] < 40.0) ++dark, dark_valid += valid;  // too weak at 500 us
  }
  CHECK(bright_valid > 0.98 * bright);
  CHECK(dark_valid > 0.98 * dark);
  CHECK(wrong == 0);
}

TEST_CASE("saturated, dark and unmodulated pixels say why they are not measured") {
  Sequence sequence;
  sequence.projector = {912, 1140};
  add_phases(sequence, Axis::kColumn, 18, 8);
  add_gray(sequence, Axis::kColumn, 9);
  white_black(sequence);
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  Scene scene = make_scene(sequence.projector, 4, 60, 5);
  scene.gain[0] = 600.0;
  scene.gain[1] = 0.0;
  Images images = image_sequence(sequence, scene, {});
  for (std::size_t f = 0; f < 8; ++f) images.frames[f][2] = 100;  // lit, but no fringe
  images.frames[15][2] = 180;
  images.frames[16][2] = 20;
  OwnDecoder decoder(*plan, images.rows, images.cols, 1);
  const auto code = decode_images(decoder, *plan, images, {});
  REQUIRE(code);
  CHECK(code->state.data[0] == PixelState::kSaturated);
  CHECK(code->state.data[1] == PixelState::kDark);
  CHECK(code->state.data[2] == PixelState::kLowModulation);
  for (int i = 0; i < 3; ++i) CHECK(std::isnan(code->column_px.data[i]));
}

TEST_CASE("frames of another size, out of turn or missing are refused") {
  Sequence sequence;
  sequence.projector = {912, 1140};
  add_gray(sequence, Axis::kColumn, 8, 0, true);
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  OwnDecoder decoder(*plan, 4, 8, 1);
  REQUIRE(decoder->begin(*plan, 4, 8, 1, 255));
  const std::vector<std::uint8_t> pixels(64, 0);
  CHECK(decoder->fold(0, ImageView<const std::uint8_t>(pixels.data(), 4, 7)).error().code ==
        ResultCode::kFrameWrongSize);
  CHECK(decoder->fold(1, ImageView<const std::uint8_t>(pixels.data(), 4, 8)).error().code == ResultCode::kFrameMissing);
  REQUIRE(decoder->fold(0, ImageView<const std::uint8_t>(pixels.data(), 4, 8)));
  CHECK(decoder->fold(0, ImageView<const std::uint8_t>(pixels.data(), 4, 8)).error().code ==
        ResultCode::kFrameDuplicated);
  CHECK(decoder->finish().error().code == ResultCode::kFrameMissing);
  CHECK(decoder->begin(*plan, 5, 8, 1, 255).error().code == ResultCode::kLimitExceeded);
}

}  // namespace
}  // namespace beltpick::testing
