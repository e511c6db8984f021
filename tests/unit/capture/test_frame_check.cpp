#include <catch2/catch.hpp>
#include <functional>
#include <memory>
#include <vector>

#include "capture/frame_check.hpp"
#include "contract/result_codes.hpp"
#include "patterns.hpp"

using namespace beltpick;

namespace {

constexpr int kRows = 240;
constexpr int kCols = 320;

// Renders captures and checks them.
class Lab {
 public:
  explicit Lab(const Sequence& sequence = patterns::standard(), double exposure_us = 5000)
      : sequence_(sequence),
        plan_(*capture::make_plan(sequence, {.exposure_us = exposure_us})),
        pixels_(kRows * kCols) {
    Arena measuring;
    const capture::FrameCheck sized(kMaxFrames, measuring);
    block_ = std::make_unique<ArenaBlock>(measuring.used_bytes());
    arena_ = Arena(block_->data(), block_->bytes());
    check_ = std::make_unique<capture::FrameCheck>(kMaxFrames, arena_);
  }

  // shown(i): which pattern of the sequence frame i shows; -1: black; -2: the bits of the frame before.
  ResultCode judge(const std::function<int(int)>& shown, const patterns::View& view = {}) {
    const ImageView<std::uint8_t> image(pixels_.data(), kRows, kCols);
    check_->begin();
    for (int i = 0; i < static_cast<int>(sequence_.frames.size()); ++i) {
      const int pattern = shown(i);
      if (pattern == -1) std::fill(pixels_.begin(), pixels_.end(), std::uint8_t{0});
      if (pattern >= 0) {
        const FrameSpec& spec = sequence_.frames[static_cast<std::size_t>(pattern)];
        patterns::View lit = view;
        if (spec.exposure_us > 0) lit.gain *= spec.exposure_us / 5000;
        patterns::render(image, spec, lit, random_);
      }
      check_->add(image);
    }
    const Result<void> verdict = check_->judge(plan_.frames);
    text_ = verdict ? "" : verdict.error().detail;
    return verdict ? ResultCode::kOk : verdict.error().code;
  }

  std::string text_;

 private:
  static constexpr int kMaxFrames = 40;
  Sequence sequence_;
  capture::CapturePlan plan_;
  std::vector<std::uint8_t> pixels_;
  std::unique_ptr<ArenaBlock> block_;
  Arena arena_;
  std::unique_ptr<capture::FrameCheck> check_;
  Random random_{5};
};

int as_armed(int i) { return i; }

}  // namespace

TEST_CASE("good captures pass, bright and dark, wide and narrow views", "[frame check]") {
  for (const double gain : {200.0, 60.0, 20.0}) {
    for (const double columns : {880.0, 400.0}) {
      Lab lab;
      const patterns::View view{.first_column = 20, .columns = columns, .gain = gain};
      for (int i = 0; i < 3; ++i) CHECK(lab.judge(as_armed, view) == ResultCode::kOk);
    }
  }
}

TEST_CASE("a black frame is found wherever it falls, once the cell has been seen", "[frame check]") {
  for (const double gain : {200.0, 30.0}) {
    for (int black = 0; black < 16; ++black) {
      Lab lab;
      REQUIRE(lab.judge(as_armed, {.gain = gain}) == ResultCode::kOk);
      CHECK(lab.judge([&](int i) { return i == black ? -1 : i; }, {.gain = gain}) == ResultCode::kFrameBlack);
      CHECK(lab.text_.find("frame " + std::to_string(black) + " ") == 0);
      CHECK(lab.judge(as_armed, {.gain = gain}) == ResultCode::kOk);
    }
  }
}

TEST_CASE("a black frame of narrow stripes is found at the first sight", "[frame check]") {
  for (const int black : {0, 3, 7, 11, 14, 15}) {
    Lab lab;
    CHECK(lab.judge([&](int i) { return i == black ? -1 : i; }) == ResultCode::kFrameBlack);
  }
}

TEST_CASE("a projector that is off is a black capture, not a good one", "[frame check]") {
  Lab lab;
  CHECK(lab.judge(as_armed, {.gain = 0}) == ResultCode::kFrameBlack);
  CHECK(lab.judge([](int) { return 16; }) == ResultCode::kFrameBlack);
}

TEST_CASE("a missed advance is found at the frame that repeats", "[frame check]") {
  for (const double gain : {200.0, 60.0, 20.0}) {
    for (int missed = 1; missed < 17; ++missed) {
      Lab lab;
      REQUIRE(lab.judge(as_armed, {.gain = gain}) == ResultCode::kOk);
      const ResultCode code = lab.judge([&](int i) { return i < missed ? i : i - 1; }, {.gain = gain});
      INFO(gain << " " << missed << " " << lab.text_);
      CHECK(code == ResultCode::kPatternRepeated);
      CHECK(lab.text_.find("frame " + std::to_string(missed) + " ") == 0);
    }
  }
}

TEST_CASE("a picture sent twice is found by its bits", "[frame check]") {
  for (int twice = 1; twice < 17; ++twice) {
    Lab lab;
    CHECK(lab.judge([&](int i) { return i == twice ? -2 : i; }) == ResultCode::kFrameDuplicated);
  }
}

TEST_CASE("an HDR capture passes: dimmer repeats are neither black nor duplicates", "[frame check]") {
  Sequence hdr;
  hdr.projector = patterns::standard().projector;
  SECTION("sequence after sequence") {
    for (const double exposure_us : {5000.0, 800.0}) {
      for (FrameSpec spec : patterns::standard().frames) {
        spec.exposure_us = exposure_us;
        hdr.frames.push_back(spec);
      }
    }
  }
  SECTION("pattern after pattern") {
    for (FrameSpec spec : patterns::standard().frames) {
      for (int repeat = 0; repeat < 2; ++repeat) hdr.frames.push_back(spec);
    }
  }
  Lab lab(hdr);
  CHECK(lab.judge(as_armed) == ResultCode::kOk);
  CHECK(lab.judge(as_armed) == ResultCode::kOk);
}
