// The lens of a foreign organised cloud, from the cloud itself.
#pragma once

#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"

namespace beltpick::pipeline {

// Fits focal lengths, principal point and distortion so that every point projects to its own pixel. Errors:
// kTooFewPoints; kFormatInvalid where no lens with its centre at the origin explains the cloud within a pixel or two.
Result<Lens> fit_lens(const RangeImage& range);

}  // namespace beltpick::pipeline
