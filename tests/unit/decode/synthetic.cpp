#include "unit/decode/synthetic.hpp"

#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/random.hpp"
#include "contract/sequences.hpp"

namespace beltpick::testing {
namespace {

double normal(Random& random) {
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum - 6.0;
}

double projected(const FrameSpec& frame, double column_px, double row_px, double blur_px) {
  if (frame.kind == FrameKind::kWhite) return 1.0;
  if (frame.kind == FrameKind::kBlack) return 0.0;
  const double x = frame.axis == Axis::kColumn ? column_px : row_px;
  if (blur_px == 0.0) return pattern_intensity(frame, x);
  constexpr int kSamples = 16;
  double sum = 0.0;
  for (int i = 0; i < kSamples; ++i) sum += pattern_intensity(frame, x + blur_px * (2.0 * (i + 0.5) / kSamples - 1.0));
  return sum / kSamples;
}

}  // namespace

Scene make_scene(const ProjectorGrid& projector, int rows, int cols, std::uint64_t seed) {
  Random random(seed);
  Scene scene{rows, cols, {}, {}, {}, {}};
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      scene.column_px.push_back(-0.5 + (c + random.uniform()) / cols * projector.width);
      scene.row_px.push_back(-0.5 + (r + random.uniform()) / rows * projector.height);
      const bool shadow = random.below(20) == 0;
      const bool dark = random.below(4) == 0;
      scene.gain.push_back(shadow ? 0.0 : dark ? random.uniform(3.0, 40.0) : random.uniform(40.0, 230.0));
      scene.ambient.push_back(random.uniform(2.0, 12.0));
    }
  }
  return scene;
}

Images image_sequence(const Sequence& sequence, const Scene& scene, const Imaging& imaging) {
  Images images{scene.rows, scene.cols, {}};
  Random random(imaging.seed);
  for (const FrameSpec& frame : sequence.frames) {
    const double exposure = frame.exposure_us > 0.0 ? frame.exposure_us / imaging.exposure_us_nominal : 1.0;
    std::vector<std::uint16_t>& pixels = images.frames.emplace_back();
    for (std::size_t i = 0; i < scene.gain.size(); ++i) {
      const double light = projected(frame, scene.column_px[i], scene.row_px[i], imaging.blur_px);
      const double level8 = exposure * (scene.gain[i] * light + scene.ambient[i]);
      const double sigma = std::sqrt(kCameraNoise.variance(static_cast<float>(level8)));
      const double noisy8 = level8 + imaging.noise * sigma * normal(random);
      const double level = std::round(noisy8 * imaging.full_scale / 255.0);
      pixels.push_back(static_cast<std::uint16_t>(std::clamp<double>(level, 0.0, imaging.full_scale)));
    }
  }
  return images;
}

std::size_t OwnDecoder::bytes_for(const decode::DecoderLimits& limits) {
  Arena measuring;
  const decode::Decoder decoder(measuring, limits);
  return measuring.used_bytes();
}

OwnDecoder::OwnDecoder(const decode::FoldPlan& plan, int rows, int cols, int pixel_bytes)
    : limits_(decode::limits_for(plan, rows, cols, pixel_bytes)),
      block_(bytes_for(limits_)),
      arena_(block_.data(), block_.bytes()),
      decoder_(arena_, limits_) {}

Result<CodeImage> decode_images(OwnDecoder& decoder, const decode::FoldPlan& plan, const Images& images,
                                const Imaging& imaging) {
  const int pixel_bytes = imaging.bits / 8;
  auto begun = decoder->begin(plan, images.rows, images.cols, pixel_bytes, imaging.full_scale);
  if (!begun) return std::unexpected(begun.error());
  for (std::size_t i = 0; i < images.frames.size(); ++i) {
    const auto& pixels = images.frames[i];
    const std::vector<std::uint8_t> bytes(pixels.begin(), pixels.end());
    const auto index = static_cast<int>(i);
    const auto folded =
        pixel_bytes == 1
            ? decoder->fold(index, ImageView<const std::uint8_t>(bytes.data(), images.rows, images.cols))
            : decoder->fold(index, ImageView<const std::uint16_t>(pixels.data(), images.rows, images.cols));
    if (!folded) return std::unexpected(folded.error());
  }
  return decoder->finish();
}

FrameSpec phase_frame(Axis axis, double period_px, int steps, int step, double offset_rad) {
  FrameSpec frame;
  frame.kind = FrameKind::kPhase;
  frame.axis = axis;
  frame.period_px = period_px;
  frame.steps = steps;
  frame.step = step;
  frame.offset_rad = offset_rad;
  return frame;
}

FrameSpec gray_frame(Axis axis, double cell_px, int bit, bool inverted) {
  FrameSpec frame;
  frame.kind = FrameKind::kGray;
  frame.axis = axis;
  frame.cell_px = cell_px;
  frame.bit = bit;
  frame.inverted = inverted;
  return frame;
}

FrameSpec plain_frame(FrameKind kind) {
  FrameSpec frame;
  frame.kind = kind;
  return frame;
}

void add_phases(Sequence& sequence, Axis axis, double period_px, int steps, double offset_rad) {
  for (int step = 0; step < steps; ++step) {
    sequence.frames.push_back(phase_frame(axis, period_px, steps, step, offset_rad));
  }
}

void add_gray(Sequence& sequence, Axis axis, double cell_px, int lowest, bool twins) {
  int highest = 0;
  while (std::ldexp(cell_px, highest + 1) < sequence.projector.extent(axis)) ++highest;
  for (int bit = highest; bit >= lowest; --bit) {
    sequence.frames.push_back(gray_frame(axis, cell_px, bit));
    if (twins) sequence.frames.push_back(gray_frame(axis, cell_px, bit, true));
  }
}

}  // namespace beltpick::testing
