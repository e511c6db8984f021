// FrameCheck: sees whether the frames of a capture can be what the sequence projected: one that stayed black, or one
// that shows the pattern of the frame before (the projector missed its advance, or the camera sent a frame twice). Both
// would decode into false depth, so they must not pass silently.
//
// It keeps a coarse grid of box means of every frame: averaging over a box brings the noise far below the difference of
// two patterns, and judging at the end needs no reference picture. What the very wide stripes may show depends on where
// the view lies in the pattern: for those the last good capture is the reference.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/image.hpp"
#include "base/result.hpp"
#include "capture/capture_plan.hpp"

namespace beltpick::capture {

class FrameCheck {
 public:
  static constexpr int kGridRows = 48;
  static constexpr int kGridCols = 64;
  static constexpr int kSamples = kGridRows * kGridCols;
  static constexpr int kBox = 4;  // pixels: the sample is the sum over a box of this side

  FrameCheck(int max_frames, Arena& arena);

  void begin() { frames_ = 0; }
  // Another sequence follows: the last good capture is no reference for it.
  void forget() { good_frames_ = 0; }
  // The next frame of the capture; at least kBox pixels wide and high. Frames beyond max_frames are not looked at.
  void add(ImageView<const std::uint8_t> image);

  // kFrameBlack, kFrameDuplicated or kPatternRepeated with the frame's number, once all frames are added. `expected`
  // tells of each what its pattern allows. A capture without fault becomes the reference of the next.
  Result<void> judge(std::span<const FrameExpectation> expected);

 private:
  // What one frame looks like beside the others of its exposure; sums over a box as in samples().
  struct Look {
    float share = 0.0F;       // of the samples that see the pattern, those in the brighter half of their range
    float spread = 0.0F;      // change from the frame before: standard deviation over the samples
    float shift = 0.0F;       // and its mean, which flickers with the ambient light
    float range = 0.0F;       // mean over the samples from darkest to brightest frame
    float usual = 0.0F;       // spread from one phase step to the next (of any two frames where there are few phases)
    bool comparable = false;  // to the frame before: the same exposure, another pattern
  };

  [[nodiscard]] std::span<const std::uint16_t> samples(int frame) const {
    return samples_.subspan(static_cast<std::size_t>(frame) * kSamples, kSamples);
  }
  bool look(std::span<const FrameExpectation> expected);
  bool look_at_exposure(std::span<const FrameExpectation> expected, double exposure_us);
  void find_range(std::span<const FrameExpectation> expected, double exposure_us);
  [[nodiscard]] float bright_share(int frame) const;
  void measure_change(int frame, Look& look) const;
  float usual_spread(std::span<const FrameExpectation> expected, double exposure_us);
  [[nodiscard]] bool identical(int frame) const;
  [[nodiscard]] static bool same_as_before(const Look& look);
  [[nodiscard]] bool stayed_black(std::size_t frame, const FrameExpectation& expected) const;
  [[nodiscard]] bool must_differ(std::size_t frame, std::span<const FrameExpectation> expected) const;

  std::span<std::uint16_t> samples_;  // frame after frame
  std::span<std::uint16_t> low_;      // of each sample over the frames of one exposure
  std::span<std::uint16_t> high_;
  std::span<Look> looks_;
  std::span<Look> good_;  // of the last good capture
  std::span<float> sorted_;
  int max_frames_;
  int frames_ = 0;
  std::size_t good_frames_ = 0;
};

}  // namespace beltpick::capture
