#include <algorithm>

#include "contract/result_codes.hpp"
#include "decode/plan_parts.hpp"

namespace beltpick::decode {
namespace {

bool same_pattern(const FrameSpec& a, const FrameSpec& b) {
  if (a.kind != b.kind) return false;
  if (a.kind == FrameKind::kWhite || a.kind == FrameKind::kBlack) return true;
  if (a.axis != b.axis) return false;
  if (a.kind == FrameKind::kGray) return a.cell_px == b.cell_px && a.bit == b.bit && a.inverted == b.inverted;
  return a.period_px == b.period_px && a.steps == b.steps && a.step == b.step && a.offset_rad == b.offset_rad;
}

bool is_reference(const FrameSpec& frame) { return frame.kind == FrameKind::kWhite || frame.kind == FrameKind::kBlack; }

// The first frame of the same pattern and exposure as the last; kNone without.
int repeated_by_last(const std::vector<FrameSpec>& frames) {
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    if (same_pattern(frames[i], frames.back()) && frames[i].exposure_us == frames.back().exposure_us) {
      return static_cast<int>(i);
    }
  }
  return kNone;
}

}  // namespace

Result<ExposureRanks> rank_exposures(const Sequence& sequence) {
  const auto& frames = sequence.frames;
  ExposureRanks ranks;
  ranks.repeated = repeated_by_last(frames);
  // The last frame then only tells what moved.
  const std::size_t count = frames.size() - (ranks.repeated != kNone ? 1 : 0);
  ranks.rank.assign(frames.size(), 0);
  if (count < frames.size()) ranks.rank.back() = ExposureRanks::kUnused;
  std::vector<int> times(count, 1);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      if (j == i || !same_pattern(frames[i], frames[j])) continue;
      if (frames[i].exposure_us == frames[j].exposure_us) {
        if (!is_reference(frames[i])) {
          return failure(ResultCode::kSequenceUndecodable,
                         "frames %zu and %zu are the same pattern at the same exposure; remove one, or give each its "
                         "exposure_us",
                         std::min(i, j), std::max(i, j));
        }
        if (j < i) ranks.rank[i] = ExposureRanks::kUnused;
        continue;
      }
      ++times[i];
      if (frames[j].exposure_us < frames[i].exposure_us && ranks.rank[i] >= 0) ++ranks.rank[i];
    }
    if (!is_reference(frames[i])) ranks.exposures = std::max(ranks.exposures, times[i]);
  }
  if (ranks.exposures > kMaxExposures) {
    return failure(ResultCode::kLimitExceeded, "the sequence has %d exposures; at most %d are supported",
                   ranks.exposures, kMaxExposures);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (ranks.rank[i] == ExposureRanks::kUnused) continue;
    if (times[i] == 1) ranks.rank[i] = ExposureRanks::kShared;
    if (times[i] != 1 && times[i] != ranks.exposures && !is_reference(frames[i])) {
      return failure(ResultCode::kSequenceUndecodable,
                     "frame %zu is captured at %d exposures, others at %d; capture it at one or at all of them", i,
                     times[i], ranks.exposures);
    }
  }
  return ranks;
}

}  // namespace beltpick::decode
