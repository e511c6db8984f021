// Whether the stripes are sharp: fine fringes that are all but even where coarse stripes light and darken the scene.
#include <cmath>

#include "contract/result_codes.hpp"
#include "decode/fringe_sums.hpp"

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
  Sharpness sharpness;
  for (int first = 0; first < levels.witnesses->count(); first += Witnesses::kBlock) {
    const FringeBlock fringe = fringe_block(levels, channel, first);
    for (int k = 0; k < fringe.count; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const float low8 = levels.witnesses->low8()[first + k];
      const float high8 = levels.witnesses->high8()[first + k];
      const float half = 0.5F * (high8 - low8);
      const float squared = fringe.cosine[n] * fringe.cosine[n] + fringe.sine[n] * fringe.sine[n];
      const bool even = std::fabs(fringe.mean[n] - low8 - half) < kNearMiddle * 2.0F * half;
      const int counts = high8 < 254.0F ? 1 : 0;
      sharpness.probes += counts;
      sharpness.washed_out += even && squared < kWashedOut * half * kWashedOut * half ? counts : 0;
      sharpness.soft += even && squared < kSoft * half * kSoft * half ? counts : 0;
    }
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
