#include "calibrate/flat_image.hpp"

#include <algorithm>
#include <cstddef>

namespace beltpick::calibrate {
namespace {

constexpr double kMaxSaturatedShare = 0.002;

bool same_period(const FrameSpec& a, const FrameSpec& b) {
  return b.kind == FrameKind::kPhase && a.axis == b.axis && a.period_px == b.period_px && a.steps == b.steps &&
         a.exposure_us == b.exposure_us;
}

// Whether the frame belongs to a set that adds up to even light: all steps of a fringe once, a Gray frame and its
// inverted twin, white.
bool is_flat_part(const FrameSpec& frame, const std::vector<FrameSpec>& all) {
  if (frame.kind == FrameKind::kWhite) return true;
  if (frame.kind == FrameKind::kPhase) {
    return std::count_if(all.begin(), all.end(), [&](const FrameSpec& other) { return same_period(frame, other); }) ==
           frame.steps;
  }
  return frame.kind == FrameKind::kGray && std::any_of(all.begin(), all.end(), [&](const FrameSpec& other) {
           return other.kind == FrameKind::kGray && other.axis == frame.axis && other.cell_px == frame.cell_px &&
                  other.bit == frame.bit && other.inverted != frame.inverted && other.exposure_us == frame.exposure_us;
         });
}

}  // namespace

FlatImage::FlatImage(const Sequence& sequence, int rows, int cols, int full_scale)
    : rows_(rows), cols_(cols), full_scale_(full_scale) {
  const auto& frames = sequence.frames;
  const bool any_flat =
      std::any_of(frames.begin(), frames.end(), [&](const FrameSpec& frame) { return is_flat_part(frame, frames); });
  for (const FrameSpec& frame : frames) {
    const bool wanted = any_flat ? is_flat_part(frame, frames) : frame.kind == FrameKind::kGray;
    int place = -1;
    if (wanted) {
      const auto found = std::find_if(exposures_.begin(), exposures_.end(),
                                      [&](const Exposure& e) { return e.exposure_us == frame.exposure_us; });
      place = static_cast<int>(found - exposures_.begin());
      if (found == exposures_.end()) exposures_.push_back({frame.exposure_us, 0, 0, {}});
    }
    exposure_of_.push_back(place);
  }
  const std::size_t pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  for (Exposure& exposure : exposures_) exposure.sum.assign(pixels, 0.0F);
}

template <class Pixel>
void FlatImage::add_any(int index, ImageView<const Pixel> image) {
  const int place = exposure_of_[static_cast<std::size_t>(index)];
  if (place < 0) return;
  Exposure& exposure = exposures_[static_cast<std::size_t>(place)];
  ++exposure.frames;
  float* sum = exposure.sum.data();
  for (int row = 0; row < rows_; ++row) {
    const Pixel* levels = image.row(row);
    for (int col = 0; col < cols_; ++col) {
      *sum++ += static_cast<float>(levels[col]);
      exposure.saturated += levels[col] >= full_scale_ ? 1 : 0;
    }
  }
}

template void FlatImage::add_any(int index, ImageView<const std::uint8_t> image);
template void FlatImage::add_any(int index, ImageView<const std::uint16_t> image);

ImageView<const float> FlatImage::finish() {
  std::sort(exposures_.begin(), exposures_.end(),
            [](const Exposure& a, const Exposure& b) { return a.exposure_us < b.exposure_us; });
  Exposure* best = &exposures_.front();
  for (Exposure& exposure : exposures_) {
    const double seen = static_cast<double>(exposure.sum.size()) * std::max(exposure.frames, 1);
    if (static_cast<double>(exposure.saturated) < kMaxSaturatedShare * seen) best = &exposure;
  }
  const float scale = 255.0F / (static_cast<float>(full_scale_) * static_cast<float>(std::max(best->frames, 1)));
  for (float& level : best->sum) level *= scale;
  return {best->sum.data(), rows_, cols_};
}

}  // namespace beltpick::calibrate
