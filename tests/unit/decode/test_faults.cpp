// Mistakes of one frame are named, and what leaves a capture usable is told as a finding; sound captures of all kinds
// raise neither.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "unit/decode/synthetic.hpp"

namespace beltpick::testing {
namespace {

constexpr int kRows = 60, kCols = 640;

struct Outcome {
  Error error;
  std::vector<Error> findings;
  std::vector<PixelState> states;
};

Sequence named(SequenceName name) {
  Sequence sequence = *make_sequence(name, {912, 1140}, SequenceAxes::kColumn);
  return sequence;
}

// Texture that varies over a few pixels, as of paint, rust or cloth; `shift_px` moves it along the rows.
Scene textured_scene(std::uint64_t seed, int shift_px = 0) {
  Scene scene = make_scene({912, 1140}, kRows, kCols, seed);
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kCols; ++c) {
      const auto at = static_cast<std::size_t>(r * kCols + c);
      const double x = c - shift_px;
      const double phase = static_cast<double>(seed) + r;
      scene.column_px[at] = -0.5 + (c + 0.5) / kCols * 912;
      scene.gain[at] = 120 + 18 * std::sin(x / 2.1 + phase) + 14 * std::sin(x / 3.7 + 2 * phase);
    }
  }
  return scene;
}

Images images_of(const Sequence& sequence, std::uint64_t seed, double blur_px = 1.0) {
  return image_sequence(sequence, textured_scene(seed), {.blur_px = blur_px, .seed = seed});
}

Outcome decode(const Sequence& sequence, const Images& images) {
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  OwnDecoder decoder(*plan, images.rows, images.cols, 1);
  const auto code = decode_images(decoder, *plan, images, {});
  Outcome outcome{code ? Error{} : code.error(), {}, {}};
  const auto findings = decoder->findings();
  outcome.findings.assign(findings.begin(), findings.end());
  if (code) outcome.states.assign(code->state.data, code->state.data + code->state.size());
  return outcome;
}

void check_named(const Outcome& outcome, ResultCode code, const std::string& words) {
  INFO(outcome.error.detail);
  CHECK(static_cast<int>(outcome.error.code) == static_cast<int>(code));
  CHECK(std::string(outcome.error.text()).find(words) != std::string::npos);
}

void check_found(const Outcome& outcome, ResultCode code) {
  INFO(outcome.error.detail << (outcome.findings.empty() ? "" : outcome.findings.front().detail));
  CHECK(outcome.error.code == ResultCode{});
  REQUIRE(outcome.findings.size() == 1);
  CHECK(static_cast<int>(outcome.findings.front().code) == static_cast<int>(code));
}

std::string file(std::size_t frame) {
  const std::string number = std::to_string(frame);
  return std::string(3 - number.size(), '0') + number + ".png";
}

// Adds to frame n the share `shares[n]` of what even light would show there.
void add_light(const Sequence& sequence, const std::vector<double>& shares, bool gain, Images& images,
               std::uint64_t seed) {
  const Scene scene = textured_scene(seed);
  for (std::size_t n = 0; n < sequence.frames.size(); ++n) {
    for (std::size_t i = 0; i < scene.gain.size(); ++i) {
      const double level = images.frames[n][i];
      const double added = shares[n % shares.size()] * (gain ? level : 0.5 * scene.gain[i]);
      images.frames[n][i] = static_cast<std::uint16_t>(std::clamp(std::lround(level + added), 0L, 255L));
    }
  }
}

TEST_CASE("sound captures raise no alarm", "[faults]") {
  for (const auto name : {SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust}) {
    const Sequence sequence = named(name);
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Outcome outcome = decode(sequence, images_of(sequence, seed, static_cast<double>(seed % 3)));
      INFO(outcome.error.detail);
      CHECK(outcome.error.code == ResultCode{});
      CHECK(outcome.findings.empty());
      CHECK(std::count(outcome.states.begin(), outcome.states.end(), PixelState::kMoved) == 0);
    }
  }
}

// Calls `spoil` for every phase frame of the finest period of each named sequence but the last `before_last`, with
// sound images of its own, the frame's number and that of the period's first.
template <class Spoil>
void for_each_phase_frame(std::size_t before_last, const Spoil& spoil) {
  for (const auto name : {SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust}) {
    const Sequence sequence = named(name);
    const std::size_t first = sequence.frames.front().kind == FrameKind::kPhase ? 0 : 2;
    const std::size_t last = first + static_cast<std::size_t>(sequence.frames[first].steps) - 1;
    for (std::size_t a = first; a + before_last <= last; ++a) spoil(sequence, images_of(sequence, a + 1), a, first);
  }
}

TEST_CASE("neighbouring phase frames exchanged are named, however fine the steps", "[faults]") {
  for_each_phase_frame(1, [](const Sequence& sequence, Images images, std::size_t a, std::size_t) {
    std::swap(images.frames[a], images.frames[a + 1]);
    check_named(decode(sequence, images), ResultCode::kSequenceOrderWrong, file(a) + " and " + file(a + 1));
  });
}

TEST_CASE("a phase frame that was dropped is named", "[faults]") {
  for_each_phase_frame(2, [](const Sequence& sequence, Images images, std::size_t a, std::size_t first) {
    images.frames.erase(images.frames.begin() + static_cast<std::ptrdiff_t>(a));
    images.frames.push_back(images.frames[first + 1]);
    check_named(decode(sequence, images), ResultCode::kFrameMissing, file(a));
  });
}

TEST_CASE("twins that are none are named", "[faults]") {
  const Sequence sequence = named(SequenceName::kRobust);
  Images images = images_of(sequence, 3);
  std::rotate(images.frames.begin() + 18, images.frames.begin() + 19,
              images.frames.end() - 1);  // one Gray frame dropped
  check_named(decode(sequence, images), ResultCode::kSequenceOrderWrong, file(18) + " and " + file(19));
}

TEST_CASE("stripes out of focus are told from frames that stand still", "[faults]") {
  const Sequence sequence = named(SequenceName::kStandard);
  check_named(decode(sequence, images_of(sequence, 4, 5.0)), ResultCode::kFocusOff, "focus");
  check_found(decode(sequence, images_of(sequence, 4, 3.7)), ResultCode::kFocusOff);
}

TEST_CASE("lamps that flicker and a projector out of step are told apart", "[faults]") {
  for (const auto name : {SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust}) {
    const Sequence sequence = named(name);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const std::vector<double> shares{0.0, 0.2, 0.05, 0.16, 0.1, 0.22, 0.03};
      Images images = images_of(sequence, seed);
      add_light(sequence, shares, false, images, seed);
      check_found(decode(sequence, images), ResultCode::kLightFlickers);
      images = images_of(sequence, seed);
      add_light(sequence, shares, true, images, seed);
      check_found(decode(sequence, images), ResultCode::kExposureBeats);
    }
  }
}

TEST_CASE("a scene that moves is told, and where the repeated pattern shows it", "[faults]") {
  for (const auto name : {SequenceName::kFast, SequenceName::kStandard, SequenceName::kRobust}) {
    const Sequence sequence = named(name);
    for (const int shift_px : {1, 2, 6}) {
      const Images later = image_sequence(sequence, textured_scene(5, shift_px), {.blur_px = 1.0, .seed = 9});
      Images images = images_of(sequence, 5);
      const auto from = static_cast<std::size_t>(sequence.frames.front().kind == FrameKind::kPhase ? 8 : 14);
      for (std::size_t n = from; n < images.frames.size(); ++n) images.frames[n] = later.frames[n];
      const Outcome outcome = decode(sequence, images);
      INFO(outcome.error.detail);
      const bool told =
          outcome.error.code == ResultCode::kBeltMovedDuringCapture ||
          (!outcome.findings.empty() && outcome.findings.front().code == ResultCode::kBeltMovedDuringCapture);
      CHECK(told);
      if (name == SequenceName::kRobust && outcome.error.code == ResultCode{} && shift_px > 1) {
        CHECK(std::count(outcome.states.begin(), outcome.states.end(), PixelState::kMoved) > kRows * kCols / 20);
      }
    }
  }
}

TEST_CASE("a Gray code alone gives positions within its cells", "[faults]") {
  Sequence sequence;
  sequence.projector = {912, 1140};
  sequence.frames = {plain_frame(FrameKind::kWhite), plain_frame(FrameKind::kBlack)};
  const double cell_px = GENERATE(1.0, 4.0, 7.125);
  const bool twins = GENERATE(false, true);
  add_gray(sequence, Axis::kColumn, cell_px, 0, twins);
  const Scene scene = textured_scene(2);
  const auto plan = decode::make_fold_plan(sequence);
  REQUIRE(plan);
  OwnDecoder decoder(*plan, kRows, kCols, 1);
  const auto code = decode_images(decoder, *plan, image_sequence(sequence, scene, {}), {});
  REQUIRE(code);
  double squares = 0.0;
  int valid = 0;
  for (std::size_t i = 0; i < code->state.size(); ++i) {
    if (code->state.data[i] != PixelState::kValid) continue;
    const double cell = std::floor((scene.column_px[i] + 0.5) / cell_px);
    const double off_px = static_cast<double>(code->column_px.data[i]) - scene.column_px[i];
    CHECK(std::abs(static_cast<double>(code->column_px.data[i]) + 0.5 - (cell + 0.5) * cell_px) <= 0.51 * cell_px);
    squares += off_px * off_px;
    ++valid;
  }
  CHECK(valid > 0.95 * kRows * kCols);
  const double rms_px = std::sqrt(squares / valid);
  INFO("cell " << cell_px << ": " << rms_px << " px");
  CHECK(rms_px <= static_cast<double>(code->column_noise.floor_px));
  if (cell_px > 3.0) CHECK(rms_px < 0.35 * cell_px / std::sqrt(12.0));
}

}  // namespace
}  // namespace beltpick::testing
