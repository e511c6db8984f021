// Whether the light is the same in every phase frame: the flicker of lamps adds to a frame what the scene's mean level
// tells, a projector that is not in step with the camera multiplies all that the frame shows.
#include <algorithm>
#include <cmath>

#include "contract/result_codes.hpp"
#include "decode/fringe_sums.hpp"
#include "decode/phase_advance.hpp"

namespace beltpick::decode {
namespace {

constexpr int kLeastWitnesses = 500;
// Ripple that adds as much to the error as the camera's noise does.
constexpr double kTolerated = 1.0;
// A projector out of step shows in the mean level too, a scene that moves hardly does; lamps show there most.
constexpr double kShownByLevel = 0.6;  // of what is tolerated
constexpr double kLevelOverGain = 0.3;
constexpr double kOfOneCause = 0.5;  // of what the mean level tells: gains that leave less unexplained are the cause

FrameVector times(const FrameMatrix& matrix, const FrameVector& vector, std::size_t count) {
  FrameVector product{};
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) product[a] += matrix[a][b] * vector[b];
  }
  return product;
}

double root_mean_square(const FrameVector& vector, std::size_t count, double freedom) {
  double squares = 0.0;
  for (std::size_t n = 0; n < count; ++n) squares += vector[n] * vector[n];
  return std::sqrt(squares / std::max(freedom, 1.0));
}

// Each frame's gain less 1, as the deviations along the fringe tell it: they are the gains seen through
// A_ab = unexplained_ab cos(shift_a - shift_b), whose eigenvalues lie in [0, 1]; iterated refinement inverts it but for
// what all frames have in common.
FrameVector find_gains(const FringeSums& sums, const FrameMatrix& left) {
  FrameMatrix seen_through{};
  FrameVector seen{};
  for (std::size_t a = 0; a < sums.frames; ++a) {
    for (std::size_t b = 0; b < sums.frames; ++b) {
      seen_through[a][b] = left[a][b] * std::cos(sums.shift_rad[a] - sums.shift_rad[b]);
    }
    seen[a] = sums.along_fringe[a] / sums.fringe_squared;
  }
  FrameVector gains{};
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds; ++round) {
    const FrameVector explained = times(seen_through, gains, sums.frames);
    for (std::size_t n = 0; n < sums.frames; ++n) gains[n] += seen[n] - explained[n];
  }
  return gains;
}

bool whole_number(double exposure_us, double flicker_us) {
  const double flickers = exposure_us / flicker_us;
  return flickers > 0.5 && std::abs(flickers - std::round(flickers)) < 0.01;
}

Error flicker(double share, double exposure_us) {
  constexpr double kMains50_us = 10000.0, kMains60_us = 25000.0 / 3.0;  // half a period of the mains
  const bool whole = whole_number(exposure_us, kMains50_us) || whole_number(exposure_us, kMains60_us);
  char exposure[64] = "the exposure";
  if (exposure_us > 0.0) std::snprintf(exposure, sizeof exposure, "the exposure of %.0f us", exposure_us);
  return failure(
             ResultCode::kLightFlickers,
             "the light of the surroundings differs from frame to frame (%.1f %% of the mean level) and adds as much "
             "to the error as the camera's noise: lamps flicker; %s %s a multiple of 10 ms (mains of 50 Hz) or "
             "8.333 ms (60 Hz)%s, or shade the cell",
             100.0 * share, whole ? "check" : "make", exposure, whole ? ", whichever your mains are" : "")
      .error();
}

Error beat(double share) {
  return failure(ResultCode::kExposureBeats,
                 "the projector's light differs from frame to frame by %.1f %%: the exposure is not a whole number of "
                 "the projector's frames, or the camera is not triggered by it; set the exposure to a multiple of its "
                 "frame time",
                 100.0 * share)
      .error();
}

}  // namespace

void check_light(const ProbeLevels& levels, const FringeSums& sums) {
  if (sums.frames < 4 || sums.witnesses < kLeastWitnesses) return;
  const auto frames = static_cast<double>(sums.frames);
  const FrameMatrix left = unexplained(sums.frames, sums.shift_rad);
  const FrameVector gains = find_gains(sums, left);
  FrameVector levels_off{};
  for (std::size_t n = 0; n < sums.frames; ++n) levels_off[n] = sums.along_mean[n] / sums.mean_squared;
  const double mean_over_noise = sums.mean / std::sqrt(sums.variance * sums.witnesses);
  const double gain = root_mean_square(gains, sums.frames, frames - 1.0);
  const FrameVector of_gains = times(left, gains, sums.frames);
  FrameVector offsets{};
  for (std::size_t n = 0; n < sums.frames; ++n) offsets[n] = levels_off[n] - of_gains[n];
  const double level = root_mean_square(levels_off, sums.frames, frames - 3.0);
  const bool gains_explain = root_mean_square(offsets, sums.frames, frames - 3.0) < kOfOneCause * level;
  const bool gains_prevail = level < gain && level > kLevelOverGain * gain;
  const bool level_shows = level * mean_over_noise > kShownByLevel * kTolerated;
  const bool beats = gain * mean_over_noise > kTolerated && (gains_explain || (gains_prevail && level_shows));
  const bool flickers = level > gain && level * mean_over_noise > kTolerated;
  if (!beats && !flickers) return;
  // Of a part of a period the harmonics of the projector's gamma look like either.
  const int channel = levels.plan->frames[static_cast<std::size_t>(sums.index[0])].accumulate.channel;
  if (periods_in_view(levels, channel) < kEvenlySpreadPeriods) return;
  levels.findings->add(beats ? beat(gain) : flicker(level, levels.exposure_us));
}

}  // namespace beltpick::decode
