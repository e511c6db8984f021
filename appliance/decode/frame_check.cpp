#include "decode/frame_check.hpp"

#include <algorithm>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"
#include "contract/result_codes.hpp"
#include "decode/fringe_sums.hpp"

namespace beltpick::decode {
namespace {

constexpr float kLitSigmas = 12.0F;     // contrast over noise of a probe that may testify
constexpr int kLeastLit = 300;          // probes; fewer prove nothing
constexpr float kNothingLevel8 = 4.0F;  // a camera that sees any light at all exceeds this

BELTPICK_KERNEL
void widen_range(const std::uint16_t* __restrict probes, std::size_t count, float to_level8, float* __restrict low8,
                 float* __restrict high8) {
  for (std::size_t i = 0; i < count; ++i) {
    const float level8 = to_level8 * static_cast<float>(probes[i]);
    low8[i] = std::min(low8[i], level8);
    high8[i] = std::max(high8[i], level8);
  }
}

void find_extremes(ProbeLevels& levels) {
  const auto count = static_cast<std::size_t>(levels.probes->count());
  std::fill_n(levels.low8.begin(), count, 1e9F);
  std::fill_n(levels.high8.begin(), count, 0.0F);
  for (int f = 0; f < levels.frames(); ++f) {
    if (!levels.of_exposure(f)) continue;
    widen_range(levels.probes->levels(f).data(), count, levels.to_level8, levels.low8.data(), levels.high8.data());
  }
  levels.lit_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float contrast = levels.high8[i] - levels.low8[i];
    const float variance = kCameraNoise.variance(0.5F * (levels.high8[i] + levels.low8[i]));
    levels.lit[i] = contrast * contrast > kLitSigmas * kLitSigmas * variance ? 1 : 0;
    levels.lit_count += levels.lit[i];
  }
}

bool all_of_exposure(const ProbeLevels& levels, const GrayCode& code) {
  return std::all_of(code.bits.begin(), code.bits.end(), [&](const GrayBit& bit) {
    return (bit.frame == kNone || levels.of_exposure(bit.frame)) &&
           (bit.twin_frame == kNone || levels.of_exposure(bit.twin_frame));
  });
}

}  // namespace

BELTPICK_KERNEL
std::uint16_t* widen_row(const std::uint8_t* pixels, int count, std::uint16_t* out) {
  for (int i = 0; i < count; ++i) out[i] = pixels[i];
  return out + count;
}
std::uint16_t* widen_row(const std::uint16_t* pixels, int count, std::uint16_t* out) {
  return std::copy_n(pixels, count, out);
}

FrameCheck::FrameCheck(Arena& arena, int rows, int cols, int frames) : probes_(arena, rows, cols, frames) {
  const auto count = static_cast<std::size_t>(FrameProbes::kRowLines * cols + FrameProbes::kColumnLines * rows);
  low8_ = arena.take<float>("frame probes", count);
  high8_ = arena.take<float>("frame probes", count);
  for (std::span<float>* row :
       {&motion_.early8, &motion_.texture8, &motion_.slope8, &motion_.late8, &motion_.late_texture8}) {
    *row = arena.take<float>("frame probes", count);
  }
  motion_.bright = arena.take<std::uint8_t>("frame probes", count);
  motion_.well_lit = arena.take<std::uint8_t>("frame probes", count);
  witnesses_ = Witnesses(arena, static_cast<int>(count), frames);
  words_ = {arena.take<std::uint16_t>("frame probes", count), arena.take<std::uint8_t>("frame probes", count)};
  lit_ = arena.take<std::uint8_t>("frame probes", count);
  steps_ = arena.take<WordStep>("frame probes", kMaxSteps);
}

FrameProbes::FrameProbes(Arena& arena, int rows, int cols, int frames)
    : capacity_(static_cast<std::size_t>(kRowLines * cols + kColumnLines * rows)),
      max_frames_(frames),
      levels_(arena.take<std::uint16_t>("frame probes", capacity_ * static_cast<std::size_t>(frames))) {}

Result<void> FrameCheck::judge(const FoldPlan& plan, int full_scale) {
  findings_.clear();
  if (auto checked = check_light_at_all(plan, full_scale); !checked) return checked;
  for (std::size_t e = 0; e < plan.exposures.size(); ++e) {
    if (auto judged = judge_exposure(plan, e, full_scale); !judged) return judged;
  }
  return {};
}

// One exposure of several may be too short for what the others show.
Result<void> FrameCheck::check_light_at_all(const FoldPlan& plan, int full_scale) const {
  const float to_level8 = 255.0F / static_cast<float>(full_scale);
  for (int f = 0; f < static_cast<int>(plan.frames.size()); ++f) {
    const auto levels = probes_.levels(f);
    if (to_level8 * static_cast<float>(*std::max_element(levels.begin(), levels.end())) >= kNothingLevel8) return {};
  }
  return failure(ResultCode::kFrameBlack, "every frame is black; check the projector and the lens cap%s",
                 full_scale > 255 ? ", and full_scale (12 bits: 4095)" : "");
}

Result<void> FrameCheck::judge_exposure(const FoldPlan& plan, std::size_t exposure, int full_scale) {
  ProbeLevels levels{.plan = &plan,
                     .probes = &probes_,
                     .to_level8 = 255.0F / static_cast<float>(full_scale),
                     .full_scale = full_scale,
                     .exposure_us = plan.exposures[exposure].exposure_us,
                     .low8 = low8_,
                     .high8 = high8_,
                     .lit = lit_,
                     .witnesses = &witnesses_,
                     .words = words_,
                     .findings = &findings_};
  find_extremes(levels);
  if (levels.lit_count < kLeastLit) return {};
  witnesses_.gather(probes_, levels.frames(), levels.to_level8, lit_, low8_, high8_);
  for (const AxisPlan& axis : plan.exposures[exposure].axes) {
    if (axis.channels.empty()) continue;
    if (auto checked = check_focus(levels, axis.channels.front()); !checked) return checked;
  }
  if (auto checked = check_levels(levels); !checked) return checked;
  for (const Axis axis : {Axis::kColumn, Axis::kRow}) {
    if (auto checked = judge_axis(levels, exposure, axis); !checked) return checked;
  }
  return check_motion(levels, motion_);
}

Result<void> FrameCheck::judge_axis(const ProbeLevels& levels, std::size_t exposure, Axis axis) {
  const FoldPlan& plan = *levels.plan;
  const AxisPlan& planned = plan.exposures[exposure].axes[static_cast<std::size_t>(axis)];
  for (const int channel : planned.channels) {
    const FringeSums sums = sum_fringe(levels, channel);
    if (auto checked = check_fringe(levels, channel, sums); !checked) return checked;
    check_light(levels, sums);
  }
  if (planned.gray == kNone) return {};
  const GrayCode& code = plan.grays[static_cast<std::size_t>(planned.gray)];
  if (!all_of_exposure(levels, code)) return {};
  if (auto checked = check_twins(levels, code); !checked) return checked;
  read_words(levels, code);
  if (auto checked = check_gray(levels, axis, code, steps_); !checked) return checked;
  if (planned.method != Method::kGrayPhase) return {};
  return check_agreement(levels, axis, code, planned.channels.front());
}

}  // namespace beltpick::decode
