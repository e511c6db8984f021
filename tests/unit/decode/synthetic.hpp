// Synthetic captures for the decoder's tests: a projector coordinate, an albedo and an ambient light for each pixel,
// imaged with the camera's noise. No geometry.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.hpp"
#include "base/result.hpp"
#include "contract/capture.hpp"
#include "decode/decoder.hpp"

namespace beltpick::testing {

struct Scene {
  int rows = 0, cols = 0;
  std::vector<double> column_px, row_px;  // the projector coordinate that each pixel sees
  std::vector<double> gain;               // level (of 255) under full projector light, ambient not included
  std::vector<double> ambient;            // level without projector light
};

// Columns run over the whole projector; a quarter of the pixels dark, some in full shadow, some bright.
Scene make_scene(const ProjectorGrid& projector, int rows, int cols, std::uint64_t seed);

struct Imaging {
  int full_scale = 255;
  int bits = 8;
  double noise = 1.0;    // times the camera's noise law
  double blur_px = 0.0;  // half width of a box over the projected pattern
  double exposure_us_nominal = 1000.0;
  std::uint64_t seed = 1;
};

struct Images {
  int rows = 0, cols = 0;
  std::vector<std::vector<std::uint16_t>> frames;
};

Images image_sequence(const Sequence& sequence, const Scene& scene, const Imaging& imaging);

// A decoder with memory of its own.
class OwnDecoder {
 public:
  OwnDecoder(const decode::FoldPlan& plan, int rows, int cols, int pixel_bytes);
  decode::Decoder& operator*() { return decoder_; }
  decode::Decoder* operator->() { return &decoder_; }

 private:
  static std::size_t bytes_for(const decode::DecoderLimits& limits);
  decode::DecoderLimits limits_;
  ArenaBlock block_;
  Arena arena_;
  decode::Decoder decoder_;
};

// Folds all frames and finishes.
Result<CodeImage> decode_images(OwnDecoder& decoder, const decode::FoldPlan& plan, const Images& images,
                                const Imaging& imaging);

// Frames of sequences.
FrameSpec phase_frame(Axis axis, double period_px, int steps, int step, double offset_rad = 0.0);
FrameSpec gray_frame(Axis axis, double cell_px, int bit, bool inverted = false);
FrameSpec plain_frame(FrameKind kind);
void add_phases(Sequence& sequence, Axis axis, double period_px, int steps, double offset_rad = 0.0);
// Bits from the highest that the extent needs down to `lowest`.
void add_gray(Sequence& sequence, Axis axis, double cell_px, int lowest = 0, bool twins = false);

}  // namespace beltpick::testing
