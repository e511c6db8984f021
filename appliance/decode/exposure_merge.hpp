// The exposures of an HDR capture merged per pixel. Internal to decode.
#pragma once

#include <cstdint>

#include "decode/finish_kernels.hpp"

namespace beltpick::decode {

// One axis of a row as one exposure measured it.
struct ExposedRow {
  AxisPixels axis;
  const float* mean8 = nullptr;  // the light that its noise goes with
  float noise_px = 0.0F;         // sigma of x times amplitude over the noise of one grey level; 0: of Gray cells
  float slack_px = 0.0F;         // what exposures may differ by besides noise
};

// What the exposures so far measured. weight = (amplitude / noise of one grey level)^2, summed where they were merged.
struct MergedRow {
  AxisPixels axis;
  float* weight = nullptr;
};

// Adds an exposure, the shortest first (`first`: it lies in `merged` already). Where both are valid: the mean by
// inverse variance, if they agree within noise; exposures that disagree are kOrderUncertain. Where neither is: the
// reason of the longest exposure that did not saturate.
void merge_exposure_row(const ExposedRow& exposed, int count, bool first, const MergedRow& merged);

// The amplitude that, with the noise of light at half the texture, has the merged weight: so CodeNoise tells the noise
// of what was merged.
void finish_merge_row(const MergedRow& merged, const std::uint8_t* texture, int count);

}  // namespace beltpick::decode
