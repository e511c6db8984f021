// Decoder: folds the frames of a capture, as they arrive, into a fixed per-pixel state, and finishes it to absolute
// projector coordinates. Allocates nothing after construction.
#pragma once

#include <cstdint>
#include <span>

#include "base/arena.hpp"
#include "base/image.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"
#include "decode/frame_check.hpp"
#include "decode/plan.hpp"
#include "decode/row_decoder.hpp"

namespace beltpick::decode {

// Codes of this many rows stay in a core's cache between decoding and triangulating them.
inline constexpr int kBandRows = 8;

// What a decoder has room for.
struct DecoderLimits {
  int rows = 0;
  int cols = 0;
  int state_bytes = kStateBytes;  // a pixel; see FoldPlan::state_bytes
  bool codes_columns = true;      // the axes that sequences may code
  bool codes_rows = false;
  int frames = 32;    // of one sequence
  int band_rows = 0;  // of the code image that are kept at once; 0: all. Whoever reads them in bands needs a band
};

// The limits that just hold `plan` for a camera of this size.
DecoderLimits limits_for(const FoldPlan& plan, int rows, int cols, int pixel_bytes);

// Whether a decoder of these limits has room for `plan` and images of rows x cols pixels. Error: kLimitExceeded.
Result<void> check_fit(const FoldPlan& plan, const DecoderLimits& limits, int rows, int cols, int pixel_bytes);

class Decoder {
 public:
  Decoder(Arena& arena, const DecoderLimits& limits);

  // Starts a capture of rows x cols pixels of pixel_bytes (1 or 2) each; full_scale > 0 is the level at which the
  // camera saturates. `plan` must outlive the capture. Error: kLimitExceeded.
  Result<void> begin(const FoldPlan& plan, int rows, int cols, int pixel_bytes, int full_scale);

  // Folds frame `index` of the sequence; the frames come in the sequence's order. Errors: kFrameWrongSize;
  // kFrameMissing or kFrameDuplicated where the index is not the next one.
  Result<void> fold(int index, ImageView<const std::uint8_t> image);
  Result<void> fold(int index, ImageView<const std::uint16_t> image);

  // The views stay good until the next begin(), but for the texture only until parts are located over the same arena.
  // Errors: kFrameMissing; kFrameBlack, kFrameDuplicated or
  // kSequenceOrderWrong where the images contradict the sequence (see FrameCheck). Wants room for all rows.
  Result<CodeImage> finish();

  // The same in bands of rows, so that the next stage reads them while they lie in the cache: begin_finish() judges the
  // frames, finish_rows() decodes adjoining bands [first, end), in any order. It gives the views of the band alone: row
  // 0 is `first`. With room for fewer rows than the image's, a band holds at most that many, and its coordinates and
  // modulation are good until the next one; texture and state of all bands stay.
  Result<CodeImage> begin_finish();
  CodeImage finish_rows(int first, int end);

  // What the last finish found that is not right, but leaves the capture usable; one line each (see FrameCheck).
  [[nodiscard]] std::span<const Error> findings() const { return check_.findings(); }

 private:
  template <class Pixel>
  Result<void> fold_any(int index, ImageView<const Pixel> image);
  void measure_ripples();
  template <class Pixel>
  void fold_repeated(int index, ImageView<const Pixel> image);
  template <class Pixel>
  void mark_moved(int row, const RowOutput& out);
  void measure_contrasts();
  // Rows [first, end).
  [[nodiscard]] CodeImage output(int first, int end) const;
  // Of the first pixel of a row in the code image, of which row `first` is kept first.
  [[nodiscard]] std::size_t code_at(int row, int first) const;

  DecoderLimits limits_;
  RowContext context_;
  RowScratch scratch_;
  FrameCheck check_;
  std::span<float> column_px_, row_px_, modulation_;
  std::span<std::uint8_t> texture_;
  std::span<PixelState> state_;
  int rows_ = 0;
  int pixel_bytes_ = 1;
  int next_frame_ = 0;
};

}  // namespace beltpick::decode
