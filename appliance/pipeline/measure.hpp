// Measure: from the frames of a capture to the range image: decode and range, in fixed memory.
#pragma once

#include <cstdint>
#include <optional>

#include "base/arena.hpp"
#include "base/image.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "contract/limits.hpp"
#include "decode/decoder.hpp"
#include "range/triangulator.hpp"

namespace beltpick::pipeline {

struct MeasureTiming {
  double fold_ms = 0.0;    // all frames, while they arrive
  double decode_ms = 0.0;  // after the last frame
  double range_ms = 0.0;
};

// The decoder's room under the declared limits: codes are kept in bands of rows.
decode::DecoderLimits decoder_limits(const Limits& limits);

// How a capture of `sequence` will be measured with `calibration`, worked out before it is needed. Errors:
// kSequenceUndecodable; kCalibrationMismatch where the projectors differ in size; kLimitExceeded where camera or
// sequence do not fit the limits.
Result<decode::FoldPlan> plan_measuring(const Sequence& sequence, const Calibration& calibration,
                                        const decode::DecoderLimits& limits, int pixel_bytes = 1);

class Measure {
 public:
  Measure(Arena& arena, const decode::DecoderLimits& limits);
  Measure(Arena& arena, const Limits& limits) : Measure(arena, decoder_limits(limits)) {}

  // What will be captured, and with which calibration. Between captures only: allocates, and takes a tenth of a second
  // where the calibration is another one. Errors: kSequenceUndecodable; kCalibrationMismatch where the projectors
  // differ in size; kLimitExceeded.
  Result<void> configure(const Sequence& sequence, const Calibration& calibration);
  // The same with what plan_measuring() made of both. Error: kLimitExceeded.
  Result<void> adopt(decode::FoldPlan plan, const Calibration& calibration);

  // From here on nothing is allocated. Starts a capture of images of the calibration's size with pixels of 1 or 2
  // bytes. Errors: kNoCalibration before configure(); kLimitExceeded where the sequence does not fit the limits.
  Result<void> begin(int pixel_bytes = 1, int full_scale = 255);

  // Folds frame `index` of the sequence. Errors as Decoder::fold.
  Result<void> fold(int index, ImageView<const std::uint8_t> image);
  Result<void> fold(int index, ImageView<const std::uint16_t> image);

  // The views stay good until the next begin(). Errors as Decoder::finish and Triangulator::measure.
  Result<RangeImage> finish();

  // Of the last finish(), until parts are located over the same arena: texture and state; coordinates and modulation
  // only where the decoder has room for all rows.
  [[nodiscard]] const CodeImage& code() const { return code_; }
  [[nodiscard]] const MeasureTiming& timing() const { return timing_; }
  [[nodiscard]] std::span<const Error> findings() const { return decoder_.findings(); }
  [[nodiscard]] const range::RangeCounts& counts() const { return triangulator_.counts(); }

 private:
  template <class Pixel>
  Result<void> fold_any(int index, ImageView<const Pixel> image);

  decode::Decoder decoder_;
  range::Triangulator triangulator_;
  std::optional<decode::FoldPlan> plan_;
  Calibration loaded_;  // whose rays the triangulator has
  int rows_ = 0, cols_ = 0;
  CodeImage code_;
  MeasureTiming timing_;
};

}  // namespace beltpick::pipeline
