// The pieces that make a FoldPlan: which frames belong to which exposure, the fringes and the Gray code of an axis.
// Internal to decode.
#pragma once

#include <vector>

#include "decode/plan.hpp"

namespace beltpick::decode {

const char* axis_name(Axis axis);

// Which exposure of an HDR capture each frame belongs to.
struct ExposureRanks {
  static constexpr int kShared = -2;  // captured once, serves every exposure
  static constexpr int kUnused = -1;  // a pattern once more at the same exposure

  int exposures = 1;
  int repeated = kNone;   // the frame that the last one shows again; kNone without
  std::vector<int> rank;  // by frame: 0 is the shortest exposure

  [[nodiscard]] bool belongs(int frame, int exposure) const {
    const int r = rank[static_cast<std::size_t>(frame)];
    return r == kShared || r == exposure;
  }
};

// Equal patterns at different exposures are the exposures of an HDR capture. The last frame may show an earlier pattern
// once more, to tell whether anything moved. Errors: kSequenceUndecodable where another pattern stands twice at one
// exposure, or at only some of the exposures; kLimitExceeded.
Result<ExposureRanks> rank_exposures(const Sequence& sequence);

// A period's frames, and each frame's least-squares weights for the fringe components.
struct PhaseFit {
  double period_px = 0.0;
  std::vector<int> frames{};
  std::vector<double> cosine_weight{}, sine_weight{};
  double noise_gain = 0.0;
  int equal_steps = 0;  // as in PhaseChannel
  double offset_rad = 0.0;
};

// The periods of one axis in one exposure, the finest first. Error: kSequenceUndecodable where the phase shifts of a
// period do not determine the phase, or its frames differ in exposure.
Result<std::vector<PhaseFit>> fit_phases(const Sequence& sequence, const ExposureRanks& ranks, int exposure, Axis axis);

// True where the phases of `periods_px` (finest first) tell every position of a range of `range_px` from every other,
// at the phase noise of an ordinary fringe.
bool phases_determine_position(const std::vector<double>& periods_px, double range_px);

// The finest whole Gray code of one axis in one exposure, bits without thresholds yet; cells = 0 where there is none.
// A frame is known by the width of its stripes, cell_px 2^bit: a code is a chain of widths, each twice the one before,
// up to the extent. Error: kSequenceUndecodable where Gray frames are there but lack one.
Result<GrayCode> chain_gray(const Sequence& sequence, const ExposureRanks& ranks, int exposure, Axis axis);

}  // namespace beltpick::decode
