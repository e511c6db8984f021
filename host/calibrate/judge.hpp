// Judges a calibration: what is too little is refused, with what to capture next; all else gets a grade and a verdict.
#pragma once

#include "base/result.hpp"
#include "calibrate/bundle.hpp"
#include "calibrate/outcome.hpp"

namespace beltpick::calibrate {

inline constexpr int kLeastPoses = 3;        // fewer do not determine two lenses
inline constexpr int kRecommendedPoses = 8;  // fewer are too few to trust without a doubt

// Before solving. Errors: kTooFewPoints (fewer than kLeastPoses; names what was left out), kCheckFailed (plates as good
// as parallel).
Result<void> check_before(const Observations& seen, const Selection& use, const std::vector<LeftOut>& left_out);

// Fills grade and verdict.
void judge(Outcome& outcome);

// Whether what was found can be a rig at all and is known well enough to measure with. Error: kCheckFailed.
Result<void> check_after(const Outcome& outcome);

}  // namespace beltpick::calibrate
