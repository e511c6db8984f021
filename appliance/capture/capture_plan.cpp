#include "capture/capture_plan.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "contract/result_codes.hpp"

namespace beltpick::capture {

namespace {

// A view of at least a third of the projector then holds a whole stripe.
constexpr double kNarrow = 1.0 / 3.0;

bool same_pattern(const FrameSpec& a, const FrameSpec& b) {
  return a.kind == b.kind && a.axis == b.axis && a.period_px == b.period_px && a.steps == b.steps && a.step == b.step &&
         a.offset_rad == b.offset_rad && a.cell_px == b.cell_px && a.bit == b.bit && a.inverted == b.inverted;
}

// Period of a frame's stripes in projector pixels; bit b of a Gray code changes every 2^(b+1) cells.
double stripe_period_px(const FrameSpec& frame) {
  return frame.kind == FrameKind::kPhase ? frame.period_px : frame.cell_px * std::exp2(frame.bit + 2);
}

FrameExpectation expect(const Sequence& sequence, std::size_t index, double exposure_us) {
  const FrameSpec& frame = sequence.frames[index];
  const bool striped = frame.kind == FrameKind::kPhase || frame.kind == FrameKind::kGray;
  FrameExpectation expected;
  expected.dark = frame.kind == FrameKind::kBlack;
  expected.bright = frame.kind == FrameKind::kWhite;
  expected.phase = frame.kind == FrameKind::kPhase;
  expected.stripes = striped && stripe_period_px(frame) < kNarrow * sequence.projector.extent(frame.axis);
  expected.repeats = index > 0 && same_pattern(sequence.frames[index - 1], frame);
  expected.exposure_us = exposure_us;
  return expected;
}

// The configured period, or the shortest where none is configured.
Result<void> take_period(protocol::Group& group, std::uint32_t shortest_us, const CaptureTiming& timing) {
  group.period_us = timing.period_us == 0 ? shortest_us : timing.period_us;
  if (group.period_us >= shortest_us && group.period_us <= protocol::kMaxPeriod_us) return {};
  return failure(ResultCode::kValueOutOfRange,
                 "capture timing: expected a period of %u to %u us for an exposure of %u us, found %u us; change the "
                 "period or shorten the exposure",
                 shortest_us, protocol::kMaxPeriod_us, group.exposure_us, group.period_us);
}

Result<void> append(CapturePlan& plan, const CaptureTiming& timing, std::uint32_t exposure_us, std::uint32_t least_us) {
  protocol::Arm& arm = plan.timing;
  protocol::Group group{1, timing.settle_us, exposure_us, 0, timing.readout_us, timing.overlap_gap_us};
  const std::uint32_t shortest_us =
      std::max(timing.settle_us + exposure_us + timing.strobe_tolerance_us, group.least_pulse_interval_us());
  if (const auto long_enough = take_period(group, shortest_us, timing); !long_enough) return long_enough;
  group.period_us = std::max(group.period_us, least_us);
  protocol::Group* const last = arm.group_count > 0 ? &arm.groups[arm.group_count - 1] : nullptr;
  if (last != nullptr && last->exposure_us == exposure_us && last->period_us == group.period_us) {
    ++last->frames;
    return {};
  }
  if (arm.group_count == protocol::kMaxGroups) {
    return failure(
        ResultCode::kLimitExceeded,
        "sequence: expected at most %d changes of exposure or period, found more; sort its frames by exposure",
        protocol::kMaxGroups - 1);
  }
  arm.groups[arm.group_count++] = group;
  return {};
}

// A shorter exposure that begins during the readout of a longer one must not end before it.
Result<void> keep_readouts_apart(protocol::Arm& arm, const CaptureTiming& timing) {
  if (timing.overlap_gap_us == 0) return {};
  for (std::uint8_t i = 1; i < arm.group_count; ++i) {
    protocol::Group& group = arm.groups[i - 1];
    const std::uint32_t both_us = group.exposure_us + group.readout_us;
    const std::uint32_t next_us = arm.groups[i].exposure_us;
    if (both_us < next_us + group.period_us) continue;
    if (const auto kept = take_period(group, both_us - next_us, timing); !kept) return kept;
  }
  return {};
}

std::int64_t duration_us(const protocol::Arm& arm) {
  std::int64_t sum_us = 0;
  for (std::uint8_t i = 0; i < arm.group_count; ++i)
    sum_us += std::int64_t{arm.groups[i].frames} * arm.groups[i].period_us;
  return sum_us;
}

}  // namespace

Result<CapturePlan> make_plan(const Sequence& sequence, const CaptureTiming& timing) {
  if (sequence.frames.empty() || sequence.frames.size() > protocol::kMaxFrames) {
    return failure(ResultCode::kLimitExceeded, "sequence: expected 1 to %d frames, found %zu; use a shorter one",
                   int{protocol::kMaxFrames}, sequence.frames.size());
  }
  static std::atomic<unsigned> plans{0};
  CapturePlan plan;
  plan.number = ++plans;
  plan.timing.host_silence_ms = timing.host_silence_ms;
  plan.timing.strobe_tolerance_us = timing.strobe_tolerance_us;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    const double told_us = sequence.frames[i].exposure_us;
    const double exposure_us = told_us > 0 ? told_us : timing.exposure_us;
    if (!(exposure_us >= 1 && exposure_us <= protocol::kMaxExposure_us)) {
      return failure(ResultCode::kValueOutOfRange, "sequence frame %zu: expected an exposure of 1 to %u us, found %g",
                     i, protocol::kMaxExposure_us, exposure_us);
    }
    const Result<void> added = append(plan, timing, static_cast<std::uint32_t>(std::lround(exposure_us)),
                                      timing.least_period_us.empty() ? 0 : timing.least_period_us[i]);
    if (!added) return std::unexpected(added.error());
    plan.frames.push_back(expect(sequence, i, exposure_us));
  }
  if (const auto apart = keep_readouts_apart(plan.timing, timing); !apart) return std::unexpected(apart.error());
  plan.duration_us = duration_us(plan.timing);
  return plan;
}

}  // namespace beltpick::capture
