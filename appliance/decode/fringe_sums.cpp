#include "decode/fringe_sums.hpp"

#include <cmath>

#include "base/camera_noise.hpp"
#include "base/units.hpp"
#include "decode/phase_advance.hpp"

namespace beltpick::decode {
namespace {

constexpr int kEvery = 3;                 // enough witnesses, and cheap
constexpr double kLeastAmplitude8 = 4.0;  // of a probe whose phase counts
constexpr double kLeastVariance = 25.0;   // of a witness's levels over their noise

// The levels of one probe as a fringe.
struct ProbeFringe {
  FrameVector level{};
  double mean = 0.0, cosine = 0.0, sine = 0.0, variance = 0.0;
};

ProbeFringe fringe_at(const ProbeLevels& levels, const FringeSums& sums, int i) {
  ProbeFringe fringe;
  for (std::size_t n = 0; n < sums.frames; ++n) {
    fringe.level[n] = static_cast<double>(levels.level8(sums.index[n], i));
    fringe.mean += fringe.level[n] / static_cast<double>(sums.frames);
    const Accumulate& work = levels.plan->frames[static_cast<std::size_t>(sums.index[n])].accumulate;
    fringe.cosine += static_cast<double>(work.cosine_weight) * fringe.level[n];
    fringe.sine += static_cast<double>(work.sine_weight) * fringe.level[n];
  }
  fringe.variance = static_cast<double>(kCameraNoise.variance(static_cast<float>(fringe.mean)));
  return fringe;
}

bool testifies(const FringeSums& sums, const ProbeFringe& fringe) {
  double squares = 0.0;
  for (std::size_t n = 0; n < sums.frames; ++n) {
    squares += (fringe.level[n] - fringe.mean) * (fringe.level[n] - fringe.mean);
  }
  return squares > kLeastVariance * fringe.variance * static_cast<double>(sums.frames);
}

void add(const ProbeFringe& fringe, FringeSums& sums) {
  ++sums.witnesses;
  sums.mean += fringe.mean;
  sums.variance += fringe.variance;
  sums.mean_squared += fringe.mean * fringe.mean / fringe.variance;
  sums.fringe_squared += 0.5 * (fringe.cosine * fringe.cosine + fringe.sine * fringe.sine) / fringe.variance;
  for (std::size_t a = 0; a < sums.frames; ++a) {
    const double level = (fringe.level[a] - fringe.mean) / fringe.variance;
    for (std::size_t b = 0; b <= a; ++b) sums.together[a][b] += level * (fringe.level[b] - fringe.mean);
    const double fitted = fringe.cosine * sums.cosine[a] - fringe.sine * sums.sine[a];
    const double off = fringe.level[a] - fringe.mean - fitted;
    sums.along_mean[a] += fringe.mean * off / fringe.variance;
    sums.along_fringe[a] += fitted * off / fringe.variance;
  }
}

}  // namespace

FringeSums sum_fringe(const ProbeLevels& levels, int channel) {
  FringeSums sums;
  const PhaseChannel& fringes = levels.plan->channels[static_cast<std::size_t>(channel)];
  if (fringes.exposure_us != levels.exposure_us || fringes.frames > static_cast<int>(kMaxFringeFrames)) return sums;
  for (int f = 0; f < levels.frames(); ++f) {
    if (levels.plan->frames[static_cast<std::size_t>(f)].accumulate.channel != channel) continue;
    const FrameSpec& spec = levels.spec(f);
    sums.shift_rad[sums.frames] = spec.offset_rad + 2.0 * kPi * spec.step / spec.steps;
    sums.cosine[sums.frames] = std::cos(sums.shift_rad[sums.frames]);
    sums.sine[sums.frames] = std::sin(sums.shift_rad[sums.frames]);
    sums.index[sums.frames++] = f;
  }
  for (int i = 0; i < levels.probes->count(); i += levels.stride()) {
    const auto at = static_cast<std::size_t>(i);
    if (levels.lit[at] == 0 || levels.high8[at] >= 254.0F) continue;
    const ProbeFringe fringe = fringe_at(levels, sums, i);
    if (testifies(sums, fringe)) add(fringe, sums);
  }
  for (std::size_t a = 0; a < sums.frames; ++a) {
    for (std::size_t b = 0; b < a; ++b) sums.together[b][a] = sums.together[a][b];
  }
  return sums;
}

double periods_in_view(const ProbeLevels& levels, int channel) {
  const auto turn_at = [&](int i) -> double {
    if (levels.lit[static_cast<std::size_t>(i)] == 0) return NAN;
    double cosine = 0.0;
    double sine = 0.0;
    for (int f = 0; f < levels.frames(); ++f) {
      const Accumulate& work = levels.plan->frames[static_cast<std::size_t>(f)].accumulate;
      if (work.channel != channel) continue;
      cosine += static_cast<double>(work.cosine_weight * levels.level8(f, i));
      sine += static_cast<double>(work.sine_weight * levels.level8(f, i));
    }
    return std::hypot(cosine, sine) < kLeastAmplitude8 ? NAN : std::atan2(sine, cosine) / (2.0 * kPi);
  };
  double most = 0.0;
  for (int first = 0, i = 0; i < levels.probes->count(); ++i) {
    if (i + 1 < levels.probes->count() && levels.probes->joined(i)) continue;
    most = std::max(most, periods_along(i + 1 - first, [&](int k) { return turn_at(first + k); }));
    first = i + 1;
  }
  return most;
}

FrameMatrix unexplained(std::size_t frames, const FrameVector& shift_rad) {
  std::array<FrameVector, 3> basis{};
  FrameMatrix left{};
  for (std::size_t n = 0; n < frames; ++n) {
    basis[0][n] = 1.0;
    basis[1][n] = std::cos(shift_rad[n]);
    basis[2][n] = std::sin(shift_rad[n]);
    left[n][n] = 1.0;
  }
  for (std::size_t k = 0; k < basis.size(); ++k) {  // Gram and Schmidt
    for (std::size_t j = 0; j < k; ++j) {
      double common = 0.0;
      for (std::size_t n = 0; n < frames; ++n) common += basis[k][n] * basis[j][n];
      for (std::size_t n = 0; n < frames; ++n) basis[k][n] -= common * basis[j][n];
    }
    double squared = 0.0;
    for (std::size_t n = 0; n < frames; ++n) squared += basis[k][n] * basis[k][n];
    if (squared < 1e-9) continue;  // the shifts do not tell it
    for (std::size_t n = 0; n < frames; ++n) basis[k][n] /= std::sqrt(squared);
    for (std::size_t a = 0; a < frames; ++a) {
      for (std::size_t b = 0; b < frames; ++b) left[a][b] -= basis[k][a] * basis[k][b];
    }
  }
  return left;
}

}  // namespace beltpick::decode
