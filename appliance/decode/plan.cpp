#include "decode/plan.hpp"

#include <cmath>

#include "base/units.hpp"
#include "contract/result_codes.hpp"
#include "decode/plan_builder.hpp"

namespace beltpick::decode {

int plane_bits(PlaneKind kind, int pixel_bytes) {
  switch (kind) {
    case PlaneKind::kSum:
    case PlaneKind::kMean:
      return 16 * pixel_bytes;
    case PlaneKind::kRaw:
      return 8 * pixel_bytes;
    case PlaneKind::kBits:
      return 2;
    case PlaneKind::kFlags:
      return 8;
  }
  return 0;
}

int FoldPlan::state_bytes(int pixel_bytes) const {
  int bits = 0;
  for (const PlaneKind kind : planes) bits += plane_bits(kind, pixel_bytes);
  return (bits + 7) / 8;
}

CodeNoise code_noise(const FoldPlan& plan, Axis axis) {
  const AxisPlan& planned = plan.exposures.front().axes[static_cast<std::size_t>(axis)];
  if (planned.method == Method::kNotCoded) return {};
  if (planned.method == Method::kGrayOnly) {
    const GrayCode& code = plan.grays[static_cast<std::size_t>(planned.gray)];
    return {.floor_px = static_cast<float>(code.cell_px / std::sqrt(12.0)), .slope_px = 0.0F};
  }
  const PhaseChannel& finest = plan.channels[static_cast<std::size_t>(planned.channels.front())];
  return {.floor_px = 0.0F, .slope_px = static_cast<float>(finest.noise_gain * finest.period_px / (2.0 * kPi))};
}

Result<FoldPlan> make_fold_plan(const Sequence& sequence) {
  if (sequence.frames.empty()) return failure(ResultCode::kSequenceUndecodable, "the sequence has no frames");
  auto ranks = rank_exposures(sequence);
  if (!ranks) return std::unexpected(ranks.error());
  for (int together = kMaxTogether; together > 1; together /= 2) {
    auto plan = PlanBuilder(sequence, *ranks, together).build();
    if (!plan || plan->state_bytes(1) <= kStateBytes) return plan;
  }
  return PlanBuilder(sequence, std::move(*ranks), 1).build();
}

}  // namespace beltpick::decode
