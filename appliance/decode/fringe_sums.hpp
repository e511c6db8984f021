// FringeSums: what the lines of probes tell about the phase frames of one period, gathered in one pass: how every two
// frames vary together, and what is common to a frame's deviations from the fringe. Internal to decode.
#pragma once

#include <array>
#include <cstddef>

#include "decode/frame_check.hpp"

namespace beltpick::decode {

inline constexpr std::size_t kMaxFringeFrames = 32;  // more of one period are not looked at
using FrameMatrix = std::array<std::array<double, kMaxFringeFrames>, kMaxFringeFrames>;
using FrameVector = std::array<double, kMaxFringeFrames>;

struct FringeSums {
  std::size_t frames = 0;
  std::array<int, kMaxFringeFrames> index{};  // in the sequence
  FrameVector shift_rad{}, cosine{}, sine{};
  int witnesses = 0;
  // Of levels less their mean, over the noise's variance: the sum over all witnesses of level_a level_b.
  FrameMatrix together{};
  // Sums over the witnesses: what a frame's deviation from the fringe has in common with the mean level, and with the
  // fringe itself.
  FrameVector along_mean{}, along_fringe{};
  double mean_squared = 0.0, fringe_squared = 0.0;
  double mean = 0.0, variance = 0.0;  // sums of the mean levels, and of the noise's variance
};

// Of some thousand probes, where they are lit and unsaturated with a fringe beyond noise. frames = 0 where they are too
// many or of other exposures.
FringeSums sum_fringe(const ProbeLevels& levels, int channel);

// The fringes of a channel at a block of witnesses.
struct FringeBlock {
  int count = 0;  // of the block's witnesses; what is beyond is of no fringe
  std::array<float, Witnesses::kBlock> cosine{}, sine{}, mean{};
};
FringeBlock fringe_block(const ProbeLevels& levels, int channel, int first_witness);

// Of the lines of probes, the most periods of a channel along one.
double periods_in_view(const ProbeLevels& levels, int channel);

// The projection that takes from a vector of levels what no fringe of these shifts can explain.
FrameMatrix unexplained(std::size_t frames, const FrameVector& shift_rad);

}  // namespace beltpick::decode
