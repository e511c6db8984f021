// FrameCheck: sees from a few lines of each frame whether a frame is black, missing, shows the pattern of the one
// before, or stands where another belongs, whether the stripes are sharp, the light steady and the scene at rest.
// Speaks up only where it is certain: a lit scene must contradict the sequence plainly.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/result.hpp"
#include "decode/findings.hpp"
#include "decode/frame_probes.hpp"
#include "decode/plan.hpp"
#include "decode/witnesses.hpp"

namespace beltpick::decode {

// What a Gray code tells at each probe: the word, and whether all of its bits are beyond doubt.
struct GrayWords {
  std::span<std::uint16_t> word;
  std::span<std::uint8_t> sure;
};

// The probes of one exposure, in levels scaled to 0..255.
struct ProbeLevels {
  const FoldPlan* plan = nullptr;
  const FrameProbes* probes = nullptr;
  float to_level8 = 1.0F;
  int full_scale = 255;
  double exposure_us = 0.0;
  std::span<float> low8, high8;  // extremes of each probe over the frames of this exposure
  std::span<std::uint8_t> lit;   // 1 where the contrast stands well out of the noise
  int lit_count = 0;
  const Witnesses* witnesses = nullptr;  // what sums over the image are taken of
  GrayWords words;                       // of the Gray code that is looked at
  Findings* findings = nullptr;          // what does not keep the capture from being used

  [[nodiscard]] float level8(int frame, int i) const {
    return to_level8 * static_cast<float>(probes->levels(frame)[static_cast<std::size_t>(i)]);
  }
  [[nodiscard]] const FrameSpec& spec(int frame) const {
    return plan->sequence.frames[static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] bool of_exposure(int frame) const { return spec(frame).exposure_us == exposure_us; }
  [[nodiscard]] int frames() const { return static_cast<int>(plan->frames.size()); }
};

// Share of the witnesses at which `holds`, a function of the witness's number.
template <class Holds>
float lit_share(const ProbeLevels& levels, const Holds& holds) {
  const int count = levels.witnesses->count();
  int held = 0;
  for (int w = 0; w < count; ++w) held += holds(w) ? 1 : 0;
  return static_cast<float>(held) / static_cast<float>(std::max(count, 1));
}

// Black and doubled frames, white and black exchanged. Errors: kFrameBlack, kFrameDuplicated, kSequenceOrderWrong.
Result<void> check_levels(const ProbeLevels& levels);
// Fringes stand out where coarser stripes do. Error, or finding where they still serve: kFocusOff.
Result<void> check_focus(const ProbeLevels& levels, int channel);

struct FringeSums;  // decode/fringe_sums.hpp
// The frames of one period form one fringe. Errors: kSequenceOrderWrong, kFrameMissing, naming the frames where one
// mistake explains what they show.
Result<void> check_fringe(const ProbeLevels& levels, int channel, const FringeSums& sums);
// Ambient and projected light are the same in every phase frame. Findings: kLightFlickers, kExposureBeats.
void check_light(const ProbeLevels& levels, const FringeSums& sums);
// Room for the levels of a texture, by probe.
struct MotionScratch {
  std::span<float> early8, texture8, slope8, late8, late_texture8;
  std::span<std::uint8_t> bright, well_lit;
};
// The texture stays where it is. Error, or finding where it moved little: kBeltMovedDuringCapture.
Result<void> check_motion(const ProbeLevels& levels, const MotionScratch& scratch);
// The frames of a bit are each other's inverse. Error: kSequenceOrderWrong.
Result<void> check_twins(const ProbeLevels& levels, const GrayCode& code);

// Where along a line of probes a Gray word changes by one bit.
struct WordStep {
  std::uint16_t before = 0, after = 0;
};
// The words of neighbours differ as those of neighbouring cells do. Error: kSequenceOrderWrong, naming two frames that
// look exchanged or one that looks inverted, where that explains it.
Result<void> check_gray(const ProbeLevels& levels, Axis axis, const GrayCode& code, std::span<WordStep> steps);
// Phase and Gray code tell of the same places. Errors: kSequenceOrderWrong, kFrameBlack.
Result<void> check_agreement(const ProbeLevels& levels, Axis axis, const GrayCode& code, int channel);

// Reads the words of a Gray code at all probes into levels.words.
void read_words(const ProbeLevels& levels, const GrayCode& code);
// Share of the lit probes at which a frame is dark (within 15 % of the contrast).
float dark_share(const ProbeLevels& levels, int frame);

class FrameCheck {
 public:
  FrameCheck() = default;
  FrameCheck(Arena& arena, int rows, int cols, int frames);

  void begin(int rows, int cols) { probes_.begin(rows, cols); }

  template <class Pixel>
  void sample_row(int index, int row, const Pixel* pixels) {
    probes_.sample_row(index, row, pixels);
  }
  template <class Pixel>
  void sample_lines(int index, ImageView<const Pixel> image) {
    probes_.sample_lines(index, image);
  }

  // Errors: kFrameBlack, kFrameDuplicated, kFrameMissing, kSequenceOrderWrong, each naming the frame's file; kFocusOff,
  // kBeltMovedDuringCapture.
  Result<void> judge(const FoldPlan& plan, int full_scale);
  // Of the last judge().
  [[nodiscard]] std::span<const Error> findings() const { return findings_.all(); }

 private:
  [[nodiscard]] Result<void> check_light_at_all(const FoldPlan& plan, int full_scale) const;
  Result<void> judge_exposure(const FoldPlan& plan, std::size_t exposure, int full_scale);
  Result<void> judge_axis(const ProbeLevels& levels, std::size_t exposure, Axis axis);

  static constexpr std::size_t kMaxSteps = 2048;
  FrameProbes probes_;
  Findings findings_;
  std::span<float> low8_, high8_;
  MotionScratch motion_;
  std::span<std::uint8_t> lit_;
  Witnesses witnesses_;
  GrayWords words_;
  std::span<WordStep> steps_;
};

}  // namespace beltpick::decode
