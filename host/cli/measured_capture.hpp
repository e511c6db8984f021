// MeasuredCapture: a CAPTURE decoded and, where there is a calibration, triangulated: what every command that takes a
// CAPTURE starts from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "contract_io/capture_io.hpp"
#include "decode/decoder.hpp"
#include "pipeline/measure.hpp"

namespace beltpick::cli {

// Sees a frame of a capture as it is folded.
using FrameSeen = std::function<void(const CaptureHeader& header, int index, const contract_io::GreyImage& image)>;

class MeasuredCapture {
 public:
  // Reads `path` frame by frame, shows progress unless `quiet`. Without a calibration range() is empty, and edges
  // are masked by the code alone. Errors: as
  // CaptureReader, make_fold_plan, Decoder and Measure; messages name the capture and, of a frame, its file.
  static Result<std::unique_ptr<MeasuredCapture>> make(const std::filesystem::path& path,
                                                       const std::optional<Calibration>& calibration,
                                                       contract_io::Warnings& warnings, bool quiet,
                                                       const FrameSeen& seen = {});

  // Views of this object's memory.
  [[nodiscard]] const CodeImage& code() const { return code_; }
  [[nodiscard]] const RangeImage& range() const { return range_; }
  [[nodiscard]] const decode::FoldPlan& plan() const { return plan_; }
  [[nodiscard]] const CaptureHeader& header() const { return header_; }
  [[nodiscard]] const pipeline::MeasureTiming& timing() const { return timing_; }
  [[nodiscard]] const range::RangeCounts& counts() const { return counts_; }
  [[nodiscard]] std::size_t memory_bytes() const { return block_->bytes(); }

 private:
  MeasuredCapture() = default;
  Result<void> decode(contract_io::CaptureReader& reader, contract_io::Warnings& warnings, bool quiet,
                      const FrameSeen& seen);
  Result<void> measure(contract_io::CaptureReader& reader, const Calibration& calibration,
                       contract_io::Warnings& warnings, bool quiet, const FrameSeen& seen);

  CaptureHeader header_;
  std::unique_ptr<ArenaBlock> block_;
  decode::FoldPlan plan_;
  std::unique_ptr<decode::Decoder> decoder_;
  std::unique_ptr<pipeline::Measure> measure_;
  CodeImage code_;
  RangeImage range_;
  pipeline::MeasureTiming timing_;
  range::RangeCounts counts_;
};

}  // namespace beltpick::cli
