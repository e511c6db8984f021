// Whether the stripes are sharp: fine fringes that are all but even where coarse stripes light and darken the scene.
#include <cmath>

#include "contract/result_codes.hpp"
#include "decode/frame_check.hpp"

namespace beltpick::decode {
namespace {

constexpr float kWashedOut = 0.12F;  // amplitude over half the contrast: in focus 0.8 and more
constexpr float kSoft = 0.4F;
constexpr float kNearMiddle = 0.3F;  // of the contrast: frames that stand still are bright or dark instead
constexpr float kMostly = 0.5F;

struct Sharpness {
  int probes = 0, washed_out = 0, soft = 0;
};

Sharpness find_sharpness(const ProbeLevels& levels, int channel) {
  const FoldPlan& plan = *levels.plan;
  Sharpness sharpness;
  for (int i = 0; i < levels.probes->count(); i += levels.stride()) {
    const auto at = static_cast<std::size_t>(i);
    if (levels.lit[at] == 0 || levels.high8[at] >= 254.0F) continue;
    float cosine = 0.0F;
    float sine = 0.0F;
    float mean = 0.0F;
    for (int f = 0; f < levels.frames(); ++f) {
      const Accumulate& work = plan.frames[static_cast<std::size_t>(f)].accumulate;
      if (work.channel != channel) continue;
      const float level8 = levels.level8(f, i);
      cosine += work.cosine_weight * level8;
      sine += work.sine_weight * level8;
      mean += level8 / static_cast<float>(plan.channels[static_cast<std::size_t>(channel)].frames);
    }
    const float contrast = levels.high8[at] - levels.low8[at];
    const float amplitude = std::hypot(cosine, sine);
    const bool even = std::fabs(mean - levels.low8[at] - 0.5F * contrast) < kNearMiddle * contrast;
    ++sharpness.probes;
    sharpness.washed_out += even && amplitude < kWashedOut * 0.5F * contrast ? 1 : 0;
    sharpness.soft += even && amplitude < kSoft * 0.5F * contrast ? 1 : 0;
  }
  return sharpness;
}

}  // namespace

Result<void> check_focus(const ProbeLevels& levels, int channel) {
  constexpr int kLeastProbes = 200;
  const PhaseChannel& fringes = levels.plan->channels[static_cast<std::size_t>(channel)];
  if (fringes.exposure_us != levels.exposure_us) return {};
  const Sharpness sharpness = find_sharpness(levels, channel);
  if (sharpness.probes < kLeastProbes) return {};
  const auto most = kMostly * static_cast<float>(sharpness.probes);
  if (static_cast<float>(sharpness.washed_out) > most) {
    return failure(
        ResultCode::kFocusOff,
        "the fringes of period %g px cannot be seen where coarser stripes can: projector or camera is out of "
        "focus, or the stripes are too fine for the camera; focus both on the objects",
        fringes.period_px);
  }
  if (static_cast<float>(sharpness.soft) > most) {
    levels.findings->add(failure(ResultCode::kFocusOff,
                                 "the fringes of period %g px keep less than %.0f %% of the contrast of coarser "
                                 "stripes: focus projector and camera on the objects",
                                 fringes.period_px, static_cast<double>(100.0F * kSoft))
                             .error());
  }
  return {};
}

}  // namespace beltpick::decode
