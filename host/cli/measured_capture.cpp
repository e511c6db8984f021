#include "measured_capture.hpp"

#include "base/clock.hpp"
#include "contract/result_codes.hpp"
#include "progress.hpp"
#include "range/code_edges.hpp"

namespace beltpick::cli {
namespace {

std::unexpected<Error> about(const std::string& what, const Error& error) {
  return failure(error.code, "%s: %s", what.c_str(), error.detail);
}

// Folds every frame of `reader` into a Decoder or a Measure.
template <class Stage>
Result<void> fold_all(contract_io::CaptureReader& reader, Stage& stage, contract_io::Warnings& warnings, bool quiet,
                      const FrameSeen& seen) {
  Progress progress("frames", reader.frames(), quiet);
  for (int i = 0; i < reader.frames(); ++i) {
    const auto image = reader.image(i, warnings);
    if (!image) return std::unexpected(image.error());
    const auto folded = image->bits == 8 ? stage.fold(i, image->view8()) : stage.fold(i, image->view16());
    if (!folded) return about(reader.header().sequence.frames[static_cast<std::size_t>(i)].file, folded.error());
    if (seen) seen(reader.header(), i, *image);
    progress.show(i + 1);
  }
  return {};
}

void warn_of(std::span<const Error> findings, const std::string& name, contract_io::Warnings& warnings) {
  for (const Error& finding : findings) {
    warnings.push_back(name + ": " + std::string(finding.text()) + " [" + std::string(result_code_name(finding.code)) +
                       "]");
  }
}

// A Stage over memory of exactly the size it asks for.
template <class Stage>
std::unique_ptr<Stage> make_stage(const decode::DecoderLimits& limits, std::unique_ptr<ArenaBlock>& block) {
  Arena measuring;
  { const Stage measured(measuring, limits); }
  block = std::make_unique<ArenaBlock>(measuring.used_bytes());
  Arena arena(block->data(), block->bytes());
  return std::make_unique<Stage>(arena, limits);
}

void mask_edges(const CodeImage& code) {
  Arena measuring;
  { const range::CodeEdges measured(measuring, code.state.cols); }
  ArenaBlock block(measuring.used_bytes());
  Arena arena(block.data(), block.bytes());
  range::CodeEdges(arena, code.state.cols).mask(code);
}

}  // namespace

Result<std::unique_ptr<MeasuredCapture>> MeasuredCapture::make(const std::filesystem::path& path,
                                                               const std::optional<Calibration>& calibration,
                                                               contract_io::Warnings& warnings, bool quiet,
                                                               const FrameSeen& seen) {
  auto reader = contract_io::CaptureReader::open(path, warnings);
  if (!reader) return std::unexpected(reader.error());
  std::unique_ptr<MeasuredCapture> made(new MeasuredCapture);
  made->header_ = reader->header();
  auto plan = decode::make_fold_plan(made->header_.sequence);
  if (!plan) return about(path.string(), plan.error());
  made->plan_ = std::move(*plan);
  const auto done = calibration ? made->measure(*reader, *calibration, warnings, quiet, seen)
                                : made->decode(*reader, warnings, quiet, seen);
  if (!done) return about(path.string(), done.error());
  return made;
}

Result<void> MeasuredCapture::decode(contract_io::CaptureReader& reader, contract_io::Warnings& warnings, bool quiet,
                                     const FrameSeen& seen) {
  const int pixel_bytes = reader.bits() / 8;
  decoder_ = make_stage<decode::Decoder>(decode::limits_for(plan_, reader.rows(), reader.cols(), pixel_bytes), block_);
  if (auto begun = decoder_->begin(plan_, reader.rows(), reader.cols(), pixel_bytes, header_.full_scale); !begun) {
    return begun;
  }
  if (auto folded = fold_all(reader, *decoder_, warnings, quiet, seen); !folded) return folded;
  const Stopwatch watch;
  auto code = decoder_->finish();
  if (!code) return std::unexpected(code.error());
  timing_.decode_ms = watch.elapsed_ms();
  code_ = *code;
  warn_of(decoder_->findings(), header_.id, warnings);
  mask_edges(code_);
  return {};
}

Result<void> MeasuredCapture::measure(contract_io::CaptureReader& reader, const Calibration& calibration,
                                      contract_io::Warnings& warnings, bool quiet, const FrameSeen& seen) {
  const int pixel_bytes = reader.bits() / 8;
  if (reader.cols() != calibration.camera.width || reader.rows() != calibration.camera.height) {
    return failure(ResultCode::kCalibrationMismatch,
                   "the calibration is of a camera image of %dx%d, the capture's images are %dx%d; use the calibration "
                   "of this camera and region",
                   calibration.camera.width, calibration.camera.height, reader.cols(), reader.rows());
  }
  measure_ =
      make_stage<pipeline::Measure>(decode::limits_for(plan_, reader.rows(), reader.cols(), pixel_bytes), block_);
  if (auto set = measure_->configure(header_.sequence, calibration); !set) return set;
  if (auto begun = measure_->begin(pixel_bytes, header_.full_scale); !begun) return begun;
  if (auto folded = fold_all(reader, *measure_, warnings, quiet, seen); !folded) return folded;
  auto range = measure_->finish();
  if (!range) return std::unexpected(range.error());
  range_ = *range;
  code_ = measure_->code();
  warn_of(measure_->findings(), header_.id, warnings);
  timing_ = measure_->timing();
  counts_ = measure_->counts();
  return {};
}

}  // namespace beltpick::cli
