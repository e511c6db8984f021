#include <algorithm>

#include "base/units.hpp"
#include "decode/exposure_merge.hpp"
#include "decode/finish_kernels.hpp"
#include "decode/gather_rows.hpp"
#include "decode/gray_subpixel.hpp"
#include "decode/order_search.hpp"
#include "decode/row_decoder.hpp"

namespace beltpick::decode {
namespace {

// Five standard deviations of phase noise stay within the eighth of a period that a complementary Gray code leaves
// between a border of its cells and the phase that would contradict it: amplitude / noise >= 5 / (pi / 4).
constexpr float kLeastPhaseSigmas = 6.4F;
// A fringe must also tell its place to 0.14 of a projector pixel (some 0.14 mm), unless that asks for much more: of
// points at that limit one in 5,000 is off by half a millimetre, by noise alone.
constexpr double kMostNoisePx = 0.14;
constexpr float kAmplePhaseSigmas = 16.0F;
// Where only the mean of the fringes is known, light is there if a fringe of this share of it would be measured.
constexpr float kLeastContrast = 0.25F;
// Light that other surfaces throw carries broad stripes, but not fine fringes. Where it exceeds half of the projector's
// own, it may turn Gray bits over; less than two thirds of the usual contrast are left to the fringes there.
constexpr float kDirectShare = 0.6F;
// What exposures may differ by without noise: a belt that settles, ambient light that flickers, saturation that starts.
constexpr float kExposureSlackPx = 0.25F;
// A bright and a dark Gray stripe lie this many standard deviations from their threshold: one in 100,000 is misread.
constexpr float kLeastGraySigmas = 4.4F;
constexpr float kGrayNoiseGain = 1.2247F;  // one frame against the mean of two: sqrt(3 / 2)

CellRule cell_rule(const GrayCode& code, const AxisPlan& axis, double period_px) {
  const bool settled = code.weak_fraction > 0.0F;  // by settle_borders_row instead
  const double guard_px = settled ? period_px : 0.25 * (code.cell_px + period_px);
  return {static_cast<float>(code.cell_px), code.cells, static_cast<float>(axis.extent_px),
          static_cast<float>(period_px), static_cast<float>(guard_px)};
}

// The coordinate from fringes, with their order from Gray code or from each other.
void order_fringes(const RowContext& context, const AxisPlan& axis, const GrayCode* code, RowScratch& scratch,
                   float* x_px) {
  if (axis.method == Method::kSearch) {
    order_search_row(*context.plan, axis, code, scratch, context.cols, x_px);
    return;
  }
  const PhaseChannel& fringes = context.plan->channels[static_cast<std::size_t>(axis.channels[0])];
  const CellRule rule = cell_rule(*code, axis, fringes.period_px);
  gray_phase_row(scratch.turn[0].data(), scratch.cell.data(), scratch.weak.data(), context.cols, rule, x_px,
                 scratch.order_safe.data());
  if (code->weak_fraction == 0.0F) return;
  settle_borders_row(scratch.cell.data(), scratch.weak.data(), scratch.amplitude8[0].data(), scratch.mean8.data(),
                     context.cols, rule, static_cast<float>(fringes.noise_gain * fringes.period_px / (2.0 * kPi)), x_px,
                     scratch.order_safe.data());
}

StateRule phase_rule(const ExposurePlan& exposure, const PhaseChannel& finest, float usual_contrast) {
  const auto sigmas = static_cast<float>(finest.period_px / (2.0 * kPi * kMostNoisePx));
  return {.least_sigmas = std::clamp(sigmas, kLeastPhaseSigmas, kAmplePhaseSigmas),
          .noise_gain = static_cast<float>(finest.noise_gain),
          .saturation_bit = exposure.saturation_bit,
          .bright_share = exposure.reference.mean_channel == kNone ? 1.0F : kLeastContrast,
          .least_contrast = kDirectShare * usual_contrast};
}

// Decodes one axis of one exposure into `out`.
template <class Pixel>
void decode_axis(const RowContext& context, const ExposurePlan& exposure, const AxisPlan& axis, RowScratch& scratch,
                 int row, float usual_contrast, const AxisPixels& out) {
  const int cols = context.cols;
  const GrayCode* code = axis.gray == kNone ? nullptr : &context.plan->grays[static_cast<std::size_t>(axis.gray)];
  if (code != nullptr) gather_gray<Pixel>(context, *code, scratch, row);
  if (axis.method == Method::kGrayOnly) {
    gray_axis_row(scratch.cell.data(), scratch.weak.data(), scratch.mean8.data(), scratch.half8.data(), cols,
                  cell_rule(*code, axis, code->cell_px), {kLeastGraySigmas, kGrayNoiseGain}, out.x_px, out.amplitude8,
                  out.state);
    if (&axis == &exposure.axes[static_cast<std::size_t>(Axis::kColumn)]) {
      refine_cells_row(scratch.cell.data(), out.state, cols, cell_rule(*code, axis, code->cell_px), scratch.runs,
                       out.x_px);
    }
    return;
  }
  RowScratch own = scratch;  // whose finest amplitudes go straight to the output
  own.amplitude8[0] = {out.amplitude8, static_cast<std::size_t>(cols)};
  for (std::size_t c = 0; c < axis.channels.size(); ++c) {
    gather_fringe<Pixel>(context, axis.channels[c], own.turn[c], own.amplitude8[c], row);
  }
  order_fringes(context, axis, code, own, out.x_px);
  const PhaseChannel& finest = context.plan->channels[static_cast<std::size_t>(axis.channels[0])];
  state_row(out.amplitude8, scratch.mean8.data(), scratch.half8.data(), scratch.order_safe.data(),
            context.store.row<const std::uint8_t>(context.plan->flags_plane, row), cols,
            phase_rule(exposure, finest, usual_contrast), out.state, out.x_px);
}

// What the merge of exposures needs to know of one that lies in `pixels`.
ExposedRow exposed_row(const FoldPlan& plan, const AxisPlan& axis, const RowScratch& scratch,
                       const AxisPixels& pixels) {
  ExposedRow exposed{.axis = pixels, .mean8 = scratch.mean8.data()};
  if (axis.channels.empty()) {
    exposed.slack_px = static_cast<float>(plan.grays[static_cast<std::size_t>(axis.gray)].cell_px);
    return exposed;
  }
  const PhaseChannel& finest = plan.channels[static_cast<std::size_t>(axis.channels[0])];
  exposed.noise_px = static_cast<float>(finest.noise_gain * finest.period_px / (2.0 * kPi));
  exposed.slack_px = kExposureSlackPx;
  return exposed;
}

// Whether the amplitude that finish_row() puts out is that of the fringes whose mean is the reference.
bool modulation_is_of(const FoldPlan& plan, int channel) {
  const auto& axes = plan.exposures.front().axes;
  const AxisPlan& first = axes[axes[0].method == Method::kNotCoded ? 1 : 0];
  return plan.exposures.size() == 1 && !first.channels.empty() && first.channels.front() == channel;
}

template <class Pixel>
void make_texture(const RowContext& context, const ExposurePlan& exposure, RowScratch& scratch, int row,
                  const RowOutput& out) {
  if (exposure.reference.white_plane != kNone) {
    texture_row(context.store.row<const Pixel>(exposure.reference.white_plane, row), context.cols,
                exposure.reference.scale * context.to_level8(), out.texture);
    return;
  }
  const float* amplitude8 = out.modulation;
  if (!modulation_is_of(*context.plan, exposure.reference.mean_channel)) {
    gather_levels<Pixel>(context, exposure.reference, scratch, row);
    gather_fringe<Pixel>(context, exposure.reference.mean_channel, scratch.turn[0], scratch.amplitude8[0], row);
    amplitude8 = scratch.amplitude8[0].data();
  }
  texture_row(scratch.mean8.data(), amplitude8, context.cols, out.texture);
}

}  // namespace

RowScratch::RowScratch(Arena& arena, int cols) {
  const auto count = static_cast<std::size_t>(cols);
  const auto take = [&]<class T>(std::span<T>& row, std::size_t elements) {
    row = arena.take<T>("decode scratch", elements);
  };
  for (auto& row : turn) take(row, count);
  for (auto& row : amplitude8) take(row, count);
  take(mean8, count);
  take(half8, count);
  take(bits, kMaxGrayBits * bit_row_bytes(cols) + kBitRowsReadAhead);
  take(level, count);
  take(reach, count);
  take(cell, count);
  take(weak, count);
  take(order_safe, count);
  take(runs, run_scratch_numbers(cols));
  for (auto& row : x_px) take(row, count);
  for (auto& row : axis_amplitude8) take(row, count);
  for (auto& row : axis_state) take(row, count);
  for (auto& row : weight) take(row, count);
}

template <class Pixel>
void finish_row(const RowContext& context, RowScratch& scratch, int row, const RowOutput& out) {
  const auto& exposures = context.plan->exposures;
  const bool both = out.x_px[0] != nullptr && out.x_px[1] != nullptr;
  // The first exposure goes straight to the output, all but the modulation and state of a second axis.
  const auto target = [&](std::size_t a) {
    return both && a == 1 ? AxisPixels{out.x_px[1], scratch.axis_amplitude8[2].data(), scratch.axis_state[2].data()}
                          : AxisPixels{out.x_px[a], out.modulation, out.state};
  };
  for (std::size_t e = 0; e < exposures.size(); ++e) {
    gather_levels<Pixel>(context, exposures[e].reference, scratch, row);
    for (std::size_t a = 0; a < 2; ++a) {
      const AxisPlan& axis = exposures[e].axes[a];
      if (axis.method == Method::kNotCoded) continue;
      const AxisPixels further{scratch.x_px[a].data(), scratch.axis_amplitude8[a].data(), scratch.axis_state[a].data()};
      const AxisPixels pixels = e == 0 ? target(a) : further;
      decode_axis<Pixel>(context, exposures[e], axis, scratch, row, context.usual_contrast[e][a], pixels);
      if (exposures.size() == 1) continue;
      merge_exposure_row(exposed_row(*context.plan, axis, scratch, pixels), context.cols, e == 0,
                         {target(a), scratch.weight[a].data()});
    }
  }
  make_texture<Pixel>(context, exposures[exposures.size() / 2], scratch, row, out);
  for (std::size_t a = 0; a < 2 && exposures.size() > 1; ++a) {
    if (out.x_px[a] != nullptr) finish_merge_row({target(a), scratch.weight[a].data()}, out.texture, context.cols);
  }
  if (both) {
    join_axes_row(scratch.axis_amplitude8[2].data(), scratch.axis_state[2].data(), context.cols, out.modulation,
                  out.state);
  }
}

template void finish_row<std::uint8_t>(const RowContext&, RowScratch&, int, const RowOutput&);
template void finish_row<std::uint16_t>(const RowContext&, RowScratch&, int, const RowOutput&);

}  // namespace beltpick::decode
