// Frames that are black, doubled or out of order are named; that sound captures raise no alarm, test_decode shows.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <utility>

#include "contract/result_codes.hpp"
#include "contract/sequences.hpp"
#include "unit/decode/synthetic.hpp"

namespace beltpick::testing {
namespace {

struct Captured {
  Sequence sequence;
  Images images;
};

// Images of a textured scene under `sequence`, in files f0.png, f1.png, ...
Captured capture_of(const Sequence& sequence) {
  Captured captured{sequence, {}};
  int number = 0;
  for (FrameSpec& frame : captured.sequence.frames) frame.file = "f" + std::to_string(number++) + ".png";
  Scene scene = make_scene(captured.sequence.projector, 60, 640, 3);
  for (std::size_t i = 0; i < scene.gain.size(); ++i) scene.gain[i] = 20.0 + 0.8 * scene.gain[i];
  captured.images = image_sequence(captured.sequence, scene, {.blur_px = 1.0});
  return captured;
}

// Frames: 0-7 phase, 8-14 Gray (bit 6 first), 15 white, 16 black.
Captured capture_example() {
  Sequence sequence;
  sequence.projector = {912, 1140};
  add_phases(sequence, Axis::kColumn, 18, 8);
  add_gray(sequence, Axis::kColumn, 9);
  sequence.frames.push_back(plain_frame(FrameKind::kWhite));
  sequence.frames.push_back(plain_frame(FrameKind::kBlack));
  return capture_of(sequence);
}

Error decode_error(const Captured& captured) {
  const auto plan = decode::make_fold_plan(captured.sequence);
  REQUIRE(plan);
  OwnDecoder decoder(*plan, captured.images.rows, captured.images.cols, 1);
  const auto code = decode_images(decoder, *plan, captured.images, {});
  return code ? Error{} : code.error();
}

void check_error(const Captured& captured, ResultCode code, const std::string& names) {
  const Error error = decode_error(captured);
  INFO(error.detail);
  CHECK(static_cast<int>(error.code) == static_cast<int>(code));
  CHECK(std::string(error.text()).find(names) != std::string::npos);
}

void blacken(Captured& captured, std::size_t frame) { captured.images.frames[frame] = captured.images.frames[16]; }

TEST_CASE("a sound capture raises no alarm") { CHECK(decode_error(capture_example()).code == ResultCode{}); }

TEST_CASE("a black frame is named") {
  for (const std::size_t frame : {0, 3, 8, 9, 11, 14, 15}) {
    Captured captured = capture_example();
    blacken(captured, frame);
    check_error(captured, ResultCode::kFrameBlack, "f" + std::to_string(frame) + ".png");
  }
  Captured captured = capture_example();
  for (auto& frame : captured.images.frames) frame.assign(frame.size(), 1);
  check_error(captured, ResultCode::kFrameBlack, "every frame");
}

TEST_CASE("a doubled frame is named") {
  for (const std::size_t frame : {1, 5, 8, 10, 14, 16}) {
    Captured captured = capture_example();
    captured.images.frames[frame] = captured.images.frames[frame - 1];
    const bool reference = frame == 16;  // black as bright as white
    if (reference) continue;
    check_error(captured, ResultCode::kFrameDuplicated, "f" + std::to_string(frame) + ".png");
  }
}

TEST_CASE("exchanged frames are named") {
  for (const auto& [a, b] : std::vector<std::pair<std::size_t, std::size_t>>{{8, 9}, {10, 12}, {13, 14}}) {
    Captured captured = capture_example();
    std::swap(captured.images.frames[a], captured.images.frames[b]);
    check_error(captured, ResultCode::kSequenceOrderWrong,
                "f" + std::to_string(a) + ".png and f" + std::to_string(b) + ".png");
  }
  Captured captured = capture_example();
  std::swap(captured.images.frames[15], captured.images.frames[16]);
  check_error(captured, ResultCode::kSequenceOrderWrong, "f15.png is declared white");
}

TEST_CASE("the highest Gray frames exchanged lead beyond the projector") {
  const auto sequence = make_sequence(SequenceName::kStandard, {912, 1140}, SequenceAxes::kColumn);
  REQUIRE(sequence);
  Captured captured = capture_of(*sequence);
  CHECK(decode_error(captured).code == ResultCode{});
  std::swap(captured.images.frames[8], captured.images.frames[9]);
  check_error(captured, ResultCode::kSequenceOrderWrong, "f8.png and f9.png");
}

TEST_CASE("phase frames out of order are told by their period") {
  Captured captured = capture_example();
  std::swap(captured.images.frames[1], captured.images.frames[4]);
  check_error(captured, ResultCode::kSequenceOrderWrong, "period 18 px");
  captured = capture_example();
  for (int i = 1; i < 4; ++i) std::swap(captured.images.frames[i], captured.images.frames[8 - i]);  // runs backwards
  check_error(captured, ResultCode::kSequenceOrderWrong, "contradict");
  captured = capture_example();
  std::rotate(captured.images.frames.begin(), captured.images.frames.begin() + 1, captured.images.frames.begin() + 8);
  check_error(captured, ResultCode::kSequenceOrderWrong, "off its Gray code");
}

TEST_CASE("an inverted Gray frame is named, and one sequence taken for another is refused") {
  Captured captured = capture_example();
  for (auto& level : captured.images.frames[12]) level = static_cast<std::uint16_t>(std::max(0, 160 - level));
  CHECK(decode_error(captured).code == ResultCode::kSequenceOrderWrong);
  captured = capture_example();
  std::rotate(captured.images.frames.begin(), captured.images.frames.begin() + 1, captured.images.frames.end());
  CHECK(decode_error(captured).code != ResultCode{});
}

}  // namespace
}  // namespace beltpick::testing
