#include "core/plan.hpp"

namespace beltpick {
namespace core {

using protocol::Arm;
using protocol::Group;
using protocol::Refusal;

namespace {

// Each time alone is bounded first, so that the sums below cannot wrap. Of the intervals between two edges of a pin the
// camera's low level is no shorter than the settle time, and the advance pulse is fixed.
Refusal judge_group(const Group& group, uint32_t tolerance_us, const BoardTiming& board) {
  if (group.frames == 0) return Refusal::kNoFrames;
  if (group.period_us > protocol::kMaxPeriod_us) return Refusal::kPeriodTooLong;
  if (group.exposure_us == 0 || group.exposure_us > protocol::kMaxExposure_us) return Refusal::kExposureOutOfRange;
  if (group.exposure_us < board.min_interval_us) return Refusal::kIntervalTooShort;
  if (group.exposure_us < board.min_exposure_us) return Refusal::kExposureOutOfRange;
  if (group.settle_us < protocol::kAdvancePulse_us) return Refusal::kSettleTooShort;
  if (group.settle_us < board.min_interval_us) return Refusal::kIntervalTooShort;
  const bool each_fits =
      group.settle_us <= group.period_us && group.readout_us <= group.period_us && tolerance_us <= group.period_us;
  if (!each_fits || group.period_us < board.min_period_us || group.period_us < group.least_pulse_interval_us() ||
      group.settle_us + group.exposure_us + tolerance_us > group.period_us) {
    return Refusal::kPeriodTooShort;
  }
  return Refusal::kNone;
}

// Where a shorter settle time follows, the next camera pulse comes closer than the period; and where a shorter exposure
// follows, its end comes closer to the readout that it overlaps.
bool ready_for_next(const Group& group, const Group& next) {
  const uint32_t interval_us = group.period_us - group.settle_us + next.settle_us;
  if (interval_us < group.least_pulse_interval_us()) return false;
  return interval_us + next.exposure_us >= group.exposure_us + group.readout_us;
}

bool same_group(const Group& a, const Group& b) {
  return a.frames == b.frames && a.settle_us == b.settle_us && a.exposure_us == b.exposure_us &&
         a.period_us == b.period_us && a.readout_us == b.readout_us && a.overlap_gap_us == b.overlap_gap_us;
}

}  // namespace

Refusal judge(const Arm& arm, const BoardTiming& board) {
  if (arm.group_count == 0) return Refusal::kNoFrames;
  if (arm.group_count > protocol::kMaxGroups) return Refusal::kTooManyGroups;
  if (arm.host_silence_ms == 0) return Refusal::kMalformed;
  uint16_t frames_left = protocol::kMaxFrames;
  for (uint8_t i = 0; i < arm.group_count; ++i) {
    const Refusal refusal = judge_group(arm.groups[i], arm.strobe_tolerance_us, board);
    if (refusal != Refusal::kNone) return refusal;
    if (arm.groups[i].frames > frames_left) return Refusal::kTooManyFrames;
    frames_left = static_cast<uint16_t>(frames_left - arm.groups[i].frames);
    if (i > 0 && !ready_for_next(arm.groups[i - 1], arm.groups[i])) return Refusal::kPeriodTooShort;
  }
  return Refusal::kNone;
}

bool same_sequence(const Arm& a, const Arm& b) {
  if (a.arm_id != b.arm_id || a.host_silence_ms != b.host_silence_ms ||
      a.strobe_tolerance_us != b.strobe_tolerance_us || a.group_count != b.group_count) {
    return false;
  }
  for (uint8_t i = 0; i < a.group_count; ++i) {
    if (!same_group(a.groups[i], b.groups[i])) return false;
  }
  return true;
}

uint16_t total_frames(const Arm& arm) {
  uint16_t frames = 0;
  for (uint8_t i = 0; i < arm.group_count; ++i) frames = static_cast<uint16_t>(frames + arm.groups[i].frames);
  return frames;
}

bool FrameCursor::advance(const Arm& arm) {
  ++frame_;
  if (++in_group_ < arm.groups[group_].frames) return true;
  in_group_ = 0;
  if (group_ + 1 >= arm.group_count) return false;
  ++group_;
  return true;
}

}  // namespace core
}  // namespace beltpick
