// The local noise of a range image against the truth, over a smooth scene.
#pragma once

#include <vector>

#include "base/stages.hpp"

namespace beltpick::bench {

struct Noise {
  int points = 0;
  int wrong = 0;  // off by more than 1 mm
  double rms_mm = 0.0;
  double predicted_mm = 0.0;  // RMS of what the noise law predicts for the same points
  double valid_share = 0.0;   // of the pixels that have a truth
};

// Distance to the truth along z and its predicted standard deviation, what varies slower than 31 pixels removed.
// `truth_mm`: rows x cols x 3, 0 or NaN where there is none.
Noise judge_noise(const RangeImage& range, const std::vector<float>& truth_mm);

}  // namespace beltpick::bench
