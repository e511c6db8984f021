// beltpick calibrate, from corners to the outcome.
//
//   first_guess  camera by Zhang's method, projector by a direct linear transform
//   refine       both lenses, stereo pose, plate poses and plate shape jointly
//   sift         bad poses and corners are left out and named; refine and sift until the choice stands
//   held_out     each pose measured by a calibration made without it
//   judge        how good it is, in words; what cannot be good is refused, with what to capture next
#pragma once

#include <functional>

#include "base/result.hpp"
#include "calibrate/outcome.hpp"

namespace beltpick::calibrate {

// Called after each of `total` steps.
using StepDone = std::function<void(int done, int total)>;

// Deterministic: the same observations give the same bits. The calibration's id is left empty. Errors: kTooFewPoints
// (fewer than three poses can be used), kCheckFailed (the poses do not determine the geometry; the detail says what to
// capture next).
Result<Outcome> calibrate(const Observations& seen, const StepDone& step_done = {});

}  // namespace beltpick::calibrate
