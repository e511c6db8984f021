#include "decode/plan_builder.hpp"
#include "contract/result_codes.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::decode {
namespace {

// A Gray cell may be as wide as the period; up to this share of it the fringe order is safe at the borders without
// looking at how near the bits are to their threshold.
constexpr double kSafeCellShare = 0.75;
// Near a border the one bit that changes there is this near its threshold, as a share of the contrast.
constexpr float kBorderWeakFraction = 0.25F;

double exposure_ratio(double numerator_us, double denominator_us) {
  if (numerator_us <= 0.0 || denominator_us <= 0.0) return 1.0;
  return numerator_us / denominator_us;
}

}  // namespace

PlanBuilder::PlanBuilder(const Sequence& sequence, ExposureRanks ranks, int together)
    : together_(together), ranks_(std::move(ranks)) {
  plan_.sequence = sequence;
  plan_.frames.resize(sequence.frames.size());
}

int PlanBuilder::add_plane(PlaneKind kind) {
  plan_.planes.push_back(kind);
  plane_ready_.push_back(0);
  return static_cast<int>(plan_.planes.size()) - 1;
}

Result<FoldPlan> PlanBuilder::build() {
  for (int i = 0; i < static_cast<int>(plan_.frames.size()); ++i) {
    const FrameKind kind = spec(i).kind;
    if ((kind != FrameKind::kWhite && kind != FrameKind::kBlack) || ranks_.rank[static_cast<std::size_t>(i)] == -1) {
      continue;
    }
    work(i).keep_plane = add_plane(PlaneKind::kRaw);
    plane_ready_.back() = i;
  }
  for (int exposure = 0; exposure < ranks_.exposures; ++exposure) {
    if (auto planned = plan_exposure(exposure); !planned) return std::unexpected(planned.error());
  }
  for (int gray = 0; gray < static_cast<int>(plan_.grays.size()); ++gray) schedule_gray(gray);
  if (!plan_.channels.empty()) plan_.flags_plane = add_plane(PlaneKind::kFlags);
  for (FrameWork& frame : plan_.frames) {
    if (frame.accumulate.channel == kNone || frame.accumulate.together == 0) continue;
    frame.accumulate.first_flags = true;
    break;
  }
  if (ranks_.repeated != kNone) {
    plan_.repeated = {ranks_.repeated, static_cast<int>(plan_.frames.size()) - 1, add_plane(PlaneKind::kRaw)};
  }
  return std::move(plan_);
}

Result<void> PlanBuilder::plan_exposure(int exposure) {
  ExposurePlan& plan = plan_.exposures.emplace_back();
  plan.saturation_bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(exposure));
  for (int i = 0; i < static_cast<int>(plan_.frames.size()); ++i) {
    const bool of_this =
        ranks_.rank[static_cast<std::size_t>(i)] == exposure || (ranks_.exposures == 1 && ranks_.belongs(i, exposure));
    if (of_this && (plan.exposure_us == 0.0 || spec(i).kind == FrameKind::kPhase)) {
      plan.exposure_us = spec(i).exposure_us;
    }
  }
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    if (auto planned = plan_axis(exposure, axis, plan.axes[static_cast<std::size_t>(axis)]); !planned) return planned;
  }
  // Thresholds of a Gray code may lean on the fringes of the other axis: so only now.
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    AxisPlan& axis_plan = plan.axes[static_cast<std::size_t>(axis)];
    if (axis_plan.gray == kNone) continue;
    auto code = chain_gray(plan_.sequence, ranks_, exposure, axis);
    if (axis_plan.method == Method::kGrayPhase &&
        code->cell_px > kSafeCellShare * plan_.channels[static_cast<std::size_t>(axis_plan.channels[0])].period_px) {
      code->weak_fraction = kBorderWeakFraction;
    }
    auto gray = add_gray(std::move(*code), axis, exposure);
    if (!gray) return std::unexpected(gray.error());
    axis_plan.gray = *gray;
  }
  if (!plan_.codes(Axis::kColumn) && !plan_.codes(Axis::kRow)) {
    return failure(ResultCode::kSequenceUndecodable,
                   "none of the %zu frames codes a projector coordinate; phase or Gray frames are needed",
                   plan_.frames.size());
  }
  plan_reference(exposure);
  return {};
}

Result<void> PlanBuilder::plan_axis(int exposure, Axis axis, AxisPlan& axis_plan) {
  axis_plan.extent_px = plan_.sequence.projector.extent(axis);
  auto fits = fit_phases(plan_.sequence, ranks_, exposure, axis);
  if (!fits) return std::unexpected(fits.error());
  auto code = chain_gray(plan_.sequence, ranks_, exposure, axis);
  if (!code) return std::unexpected(code.error());
  return choose_method(*fits, *code, axis, axis_plan);
}

Result<void> PlanBuilder::choose_method(const std::vector<PhaseFit>& fits, const GrayCode& code, Axis axis,
                                        AxisPlan& axis_plan) {
  const bool has_gray = code.cells > 0;
  if (has_gray) axis_plan.gray = 0;  // numbered when its thresholds are known
  if (fits.empty()) {
    axis_plan.method = has_gray ? Method::kGrayOnly : Method::kNotCoded;
    return {};
  }
  const double finest_px = fits.front().period_px;
  const bool alone = fits.size() == 1 || code.cell_px <= kSafeCellShare * finest_px;
  if (has_gray && alone && code.cell_px <= finest_px * (1.0 + 1e-6)) {
    axis_plan.method = Method::kGrayPhase;
    axis_plan.channels = {add_channel(fits.front())};
    return {};
  }
  std::vector<double> periods_px;
  for (const PhaseFit& fit : fits) periods_px.push_back(fit.period_px);
  const double range_px = has_gray ? code.cell_px + 0.5 * finest_px : axis_plan.extent_px;
  if (!phases_determine_position(periods_px, range_px)) {
    return failure(ResultCode::kSequenceUndecodable,
                   "%s axis: the fringe order is not determined: %zu period(s), the finest %g px, over %g px%s; add a "
                   "Gray code with cells of half the period, or further periods",
                   axis_name(axis), fits.size(), finest_px, has_gray ? code.cell_px : axis_plan.extent_px,
                   has_gray ? " of a Gray cell" : "");
  }
  axis_plan.method = Method::kSearch;
  for (const PhaseFit& fit : fits) axis_plan.channels.push_back(add_channel(fit));
  return {};
}

int PlanBuilder::add_channel(const PhaseFit& fit) {
  const int known = work(fit.frames.front()).accumulate.channel;
  if (known != kNone) return known;  // captured once for all exposures
  PhaseChannel channel{.period_px = fit.period_px, .frames = static_cast<int>(fit.frames.size())};
  channel.cosine_plane = add_plane(PlaneKind::kSum);
  channel.sine_plane = add_plane(PlaneKind::kSum);
  channel.noise_gain = fit.noise_gain;
  channel.exposure_us = spec(fit.frames.front()).exposure_us;
  channel.last_frame = fit.frames.back();
  channel.equal_steps = fit.equal_steps;
  channel.offset_rad = fit.offset_rad;
  // The sums of positive and of negative weights are equal: a partial sum cannot exceed either at the brightest level.
  double cosine_bound = 0.0;
  double sine_bound = 0.0;
  for (std::size_t n = 0; n < fit.frames.size(); ++n) {
    cosine_bound += std::max(fit.cosine_weight[n], 0.0);
    sine_bound += std::max(fit.sine_weight[n], 0.0);
  }
  channel.counts_per_level = 32600.0 / (255.0 * std::max(cosine_bound, sine_bound));
  for (std::size_t n = 0; n < fit.frames.size(); ++n) {
    Accumulate& accumulate = work(fit.frames[n]).accumulate;
    accumulate.channel = static_cast<int>(plan_.channels.size());
    accumulate.cosine_weight = static_cast<float>(fit.cosine_weight[n]);
    accumulate.sine_weight = static_cast<float>(fit.sine_weight[n]);
    const double q15 = 256.0 * channel.counts_per_level;  // level << 7, product >> 15
    accumulate.cosine_weight_q15 = static_cast<std::int16_t>(std::lround(q15 * fit.cosine_weight[n]));
    accumulate.sine_weight_q15 = static_cast<std::int16_t>(std::lround(q15 * fit.sine_weight[n]));
    const int rank = ranks_.rank[static_cast<std::size_t>(fit.frames[n])];
    accumulate.saturation_bit = static_cast<std::uint8_t>(rank < 0 ? 0xFF : 1U << static_cast<unsigned>(rank));
    channel.saturation_bits = accumulate.saturation_bit;
  }
  group_frames(fit);
  plan_.channels.push_back(channel);
  return static_cast<int>(plan_.channels.size()) - 1;
}

// Parts a period's frames into groups of nearly the same size; all but the last frame of a group wait for it.
void PlanBuilder::group_frames(const PhaseFit& fit) {
  const int frames = static_cast<int>(fit.frames.size());
  const int groups = (frames + together_ - 1) / together_;
  for (int group = 0; group < groups; ++group) {
    const int begin = group * frames / groups;
    const int last = (group + 1) * frames / groups - 1;
    const int last_frame = fit.frames[static_cast<std::size_t>(last)];
    Accumulate& accumulate = work(last_frame).accumulate;
    accumulate.first = group == 0;
    accumulate.last = group == groups - 1;
    accumulate.together = last - begin + 1;
    for (int n = begin; n < last; ++n) {
      const int frame = fit.frames[static_cast<std::size_t>(n)];
      work(frame).keep_plane = borrow_raw_plane(frame, last_frame);
      accumulate.earlier[static_cast<std::size_t>(n - begin)] = frame;
    }
  }
}

int PlanBuilder::mean_channel(int exposure, Axis axis) const {
  const auto& axes = plan_.exposures[static_cast<std::size_t>(exposure)].axes;
  const auto& own = axes[static_cast<std::size_t>(axis)].channels;
  const auto& other = axes[1 - static_cast<std::size_t>(axis)].channels;
  if (!own.empty()) return own.front();
  return other.empty() ? kNone : other.front();
}

int PlanBuilder::reference_plane(FrameKind kind, double exposure_us, double& found_us) const {
  int plane = kNone;
  double least = INFINITY;
  for (int i = 0; i < static_cast<int>(plan_.frames.size()); ++i) {
    const int kept = plan_.frames[static_cast<std::size_t>(i)].keep_plane;
    if (spec(i).kind != kind || kept == kNone) continue;
    const double distance = std::abs(std::log(exposure_ratio(exposure_us, spec(i).exposure_us)));
    if (distance >= least) continue;
    least = distance;
    plane = kept;
    found_us = spec(i).exposure_us;
  }
  return plane;
}

Reference PlanBuilder::reference_near(double exposure_us, double& white_us) const {
  double black_us = 0.0;
  return {.white_plane = reference_plane(FrameKind::kWhite, exposure_us, white_us),
          .black_plane = reference_plane(FrameKind::kBlack, exposure_us, black_us)};
}

void PlanBuilder::plan_reference(int exposure) {
  ExposurePlan& plan = plan_.exposures[static_cast<std::size_t>(exposure)];
  double white_us = 0.0;
  plan.reference = reference_near(plan.exposure_us, white_us);
  plan.reference.scale = static_cast<float>(exposure_ratio(plan.exposure_us, white_us));
  if (plan.reference.white_plane != kNone && plan.reference.black_plane != kNone) return;
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    const int gray = plan.axes[static_cast<std::size_t>(axis)].gray;
    if (gray == kNone) continue;
    const GrayCode& code = plan_.grays[static_cast<std::size_t>(gray)];
    const bool twins = std::any_of(code.bits.begin(), code.bits.end(),
                                   [](const GrayBit& bit) { return bit.threshold.kind == ThresholdKind::kTwin; });
    if (!twins) continue;
    plan.reference = {};
    watch_extremes(code, plan.reference);
    return;
  }
  const int channel = mean_channel(exposure, Axis::kColumn);
  if (channel == kNone) return;
  plan_mean(channel);
  plan.reference.mean_channel = channel;
}

void PlanBuilder::plan_mean(int channel) {
  PhaseChannel& fringes = plan_.channels[static_cast<std::size_t>(channel)];
  if (fringes.mean_plane != kNone) return;
  fringes.mean_plane = add_plane(PlaneKind::kMean);
  plane_ready_.back() = fringes.last_frame;
}

void PlanBuilder::watch_extremes(const GrayCode& code, Reference& reference) {
  int first = static_cast<int>(plan_.frames.size());
  for (const GrayBit& bit : code.bits) {
    if (bit.threshold.kind == ThresholdKind::kTwin) first = std::min({first, bit.frame, bit.twin_frame});
  }
  if (work(first).extremes.white_plane != kNone) {
    reference = work(first).extremes;
    return;
  }
  reference.white_plane = add_plane(PlaneKind::kRaw);
  reference.black_plane = add_plane(PlaneKind::kRaw);
  for (const GrayBit& bit : code.bits) {
    if (bit.threshold.kind != ThresholdKind::kTwin) continue;
    work(bit.frame).extremes = work(bit.twin_frame).extremes = reference;
  }
  work(first).first_extremes = true;
}

}  // namespace beltpick::decode
