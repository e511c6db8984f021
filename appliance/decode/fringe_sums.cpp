#include "decode/fringe_sums.hpp"

#include <algorithm>
#include <cmath>

#include "base/camera_noise.hpp"
#include "base/kernel.hpp"
#include "base/units.hpp"
#include "decode/phase_advance.hpp"

namespace beltpick::decode {
namespace {

constexpr double kLeastAmplitude8 = 4.0;  // of a probe whose phase counts
constexpr float kLeastVariance = 25.0F;   // of a witness's levels over their noise
constexpr float kSaturated8 = 254.0F;

using Block = std::array<float, Witnesses::kBlock>;

// The levels of a block of witnesses less their mean, and the noise's weight: 0 where there is no fringe to speak of.
struct LevelBlock {
  FringeBlock fringe;
  std::array<Block, kMaxFringeFrames> deviation{};
  Block variance{}, weight{};
};

BELTPICK_KERNEL
void add_levels(const float* __restrict level8, float cosine_weight, float sine_weight, float share,
                FringeBlock& fringe) {
  for (std::size_t k = 0; k < fringe.mean.size(); ++k) {
    fringe.cosine[k] += cosine_weight * level8[k];
    fringe.sine[k] += sine_weight * level8[k];
    fringe.mean[k] += share * level8[k];
  }
}

BELTPICK_KERNEL
void take_off(const float* __restrict level8, const Block& mean, Block& deviation, Block& squares) {
  for (std::size_t k = 0; k < mean.size(); ++k) {
    deviation[k] = level8[k] - mean[k];
    squares[k] += deviation[k] * deviation[k];
  }
}

// The sum over a block of a b.
BELTPICK_KERNEL
float dot(const Block& a, const Block& b) {
  constexpr std::size_t kLanes = 16;
  alignas(64) std::array<float, kLanes> lanes{};
  for (std::size_t k = 0; k < a.size(); k += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] += a[k + lane] * b[k + lane];
  }
  for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::size_t lane = 0; lane < half; ++lane) lanes[lane] += lanes[lane + half];
  }
  return lanes[0];
}

LevelBlock level_block(const ProbeLevels& levels, const FringeSums& sums, int first) {
  LevelBlock block;
  const int channel = levels.plan->frames[static_cast<std::size_t>(sums.index[0])].accumulate.channel;
  block.fringe = fringe_block(levels, channel, first);
  Block squares{};
  for (std::size_t n = 0; n < sums.frames; ++n) {
    take_off(levels.witnesses->level8(sums.index[n]) + first, block.fringe.mean, block.deviation[n], squares);
  }
  const float* high8 = levels.witnesses->high8() + first;
  for (std::size_t k = 0; k < static_cast<std::size_t>(block.fringe.count); ++k) {
    block.variance[k] = kCameraNoise.variance(block.fringe.mean[k]);
    const bool varies = squares[k] > kLeastVariance * block.variance[k] * static_cast<float>(sums.frames);
    block.weight[k] = varies && high8[k] < kSaturated8 ? 1.0F / block.variance[k] : 0.0F;
  }
  return block;
}

void add(const LevelBlock& block, FringeSums& sums) {
  const FringeBlock& fringe = block.fringe;
  Block weighted_mean{}, weighted_cosine{}, weighted_sine{}, counted_mean{}, counted{};
  for (std::size_t k = 0; k < counted.size(); ++k) {
    counted[k] = block.weight[k] > 0.0F ? 1.0F : 0.0F;
    counted_mean[k] = counted[k] * fringe.mean[k];
    weighted_mean[k] = block.weight[k] * fringe.mean[k];
    weighted_cosine[k] = block.weight[k] * fringe.cosine[k];
    weighted_sine[k] = block.weight[k] * fringe.sine[k];
  }
  const auto sum = [](const Block& a, const Block& b) { return static_cast<double>(dot(a, b)); };
  sums.witnesses += static_cast<int>(sum(counted, counted));
  sums.mean += sum(counted_mean, counted);
  sums.variance += sum(block.variance, counted);
  sums.mean_squared += sum(weighted_mean, fringe.mean);
  sums.fringe_squared += 0.5 * (sum(weighted_cosine, fringe.cosine) + sum(weighted_sine, fringe.sine));
  for (std::size_t a = 0; a < sums.frames; ++a) {
    Block weighted{}, fitted{}, off{};
    const auto cosine = static_cast<float>(sums.cosine[a]);
    const auto sine = static_cast<float>(sums.sine[a]);
    for (std::size_t k = 0; k < weighted.size(); ++k) {
      weighted[k] = block.weight[k] * block.deviation[a][k];
      fitted[k] = fringe.cosine[k] * cosine - fringe.sine[k] * sine;
      off[k] = block.weight[k] * (block.deviation[a][k] - fitted[k]);
    }
    for (std::size_t b = 0; b <= a; ++b) sums.together[a][b] += sum(weighted, block.deviation[b]);
    sums.along_mean[a] += sum(fringe.mean, off);
    sums.along_fringe[a] += sum(fitted, off);
  }
}

}  // namespace

FringeBlock fringe_block(const ProbeLevels& levels, int channel, int first_witness) {
  FringeBlock fringe;
  fringe.count = std::min(Witnesses::kBlock, levels.witnesses->count() - first_witness);
  const float share = 1.0F / static_cast<float>(levels.plan->channels[static_cast<std::size_t>(channel)].frames);
  for (int f = 0; f < levels.frames(); ++f) {
    const Accumulate& work = levels.plan->frames[static_cast<std::size_t>(f)].accumulate;
    if (work.channel != channel) continue;
    add_levels(levels.witnesses->level8(f) + first_witness, work.cosine_weight, work.sine_weight, share, fringe);
  }
  return fringe;
}

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
  if (sums.frames == 0) return sums;
  for (int first = 0; first < levels.witnesses->count(); first += Witnesses::kBlock) {
    add(level_block(levels, sums, first), sums);
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
