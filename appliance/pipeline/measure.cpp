#include "pipeline/measure.hpp"

#include <algorithm>
#include <utility>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::pipeline {

decode::DecoderLimits decoder_limits(const Limits& limits) {
  return {.rows = limits.image_height,
          .cols = limits.image_width,
          .state_bytes = limits.decode_bytes,
          .codes_columns = true,
          .codes_rows = limits.code_rows,
          .frames = limits.frames,
          .band_rows = decode::kBandRows};
}

Measure::Measure(Arena& arena, const decode::DecoderLimits& limits)
    : decoder_(arena, limits), triangulator_(arena, limits.rows, limits.cols) {}

namespace {

Result<decode::FoldPlan> plan_for(const Sequence& sequence, const Calibration& calibration) {
  const Lens& projector = calibration.projector;
  if (sequence.projector.width != projector.width || sequence.projector.height != projector.height) {
    return failure(ResultCode::kCalibrationMismatch,
                   "the calibration is of a projector of %dx%d, the sequence is for %dx%d; calibrate with this "
                   "projector",
                   projector.width, projector.height, sequence.projector.width, sequence.projector.height);
  }
  return decode::make_fold_plan(sequence);
}

}  // namespace

Result<decode::FoldPlan> plan_measuring(const Sequence& sequence, const Calibration& calibration,
                                        const decode::DecoderLimits& limits, int pixel_bytes) {
  auto plan = plan_for(sequence, calibration);
  if (!plan) return plan;
  const Lens& camera = calibration.camera;
  if (auto fits = decode::check_fit(*plan, limits, camera.height, camera.width, pixel_bytes); !fits) {
    return std::unexpected(fits.error());
  }
  return plan;
}

Result<void> Measure::configure(const Sequence& sequence, const Calibration& calibration) {
  plan_.reset();
  auto plan = plan_for(sequence, calibration);
  return plan ? adopt(std::move(*plan), calibration) : std::unexpected(plan.error());
}

Result<void> Measure::adopt(decode::FoldPlan plan, const Calibration& calibration) {
  plan_.reset();
  if (!(calibration == loaded_)) {
    loaded_ = {};
    if (auto loaded = triangulator_.load(calibration); !loaded) return loaded;
    loaded_ = calibration;
  }
  rows_ = calibration.camera.height;
  cols_ = calibration.camera.width;
  plan_ = std::move(plan);
  return {};
}

Result<void> Measure::begin(int pixel_bytes, int full_scale) {
  if (!plan_) return failure(ResultCode::kNoCalibration, "no sequence and calibration are configured to measure with");
  timing_ = {};
  return decoder_.begin(*plan_, rows_, cols_, pixel_bytes, full_scale);
}

template <class Pixel>
Result<void> Measure::fold_any(int index, ImageView<const Pixel> image) {
  const Stopwatch watch;
  auto folded = decoder_.fold(index, image);
  timing_.fold_ms += watch.elapsed_ms();
  return folded;
}

Result<void> Measure::fold(int index, ImageView<const std::uint8_t> image) { return fold_any(index, image); }
Result<void> Measure::fold(int index, ImageView<const std::uint16_t> image) { return fold_any(index, image); }

Result<RangeImage> Measure::finish() {
  Stopwatch watch;
  const auto code = decoder_.begin_finish();
  if (!code) return std::unexpected(code.error());
  code_ = *code;
  timing_.decode_ms = watch.elapsed_ms();
  auto range = triangulator_.begin(code_);
  if (!range) return range;
  for (int first = 0; first < rows_; first += decode::kBandRows) {
    watch = Stopwatch();
    const CodeImage band = decoder_.finish_rows(first, std::min(first + decode::kBandRows, rows_));
    timing_.decode_ms += watch.elapsed_ms();
    watch = Stopwatch();
    triangulator_.measure_rows(band, first);
    timing_.range_ms += watch.elapsed_ms();
  }
  return range;
}

}  // namespace beltpick::pipeline
