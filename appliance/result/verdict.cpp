#include "result/verdict.hpp"

#include <algorithm>

#include "contract/result_codes.hpp"

namespace beltpick::result {
namespace {

// A gap that no shadow explains weighs more against a pose than as much measured surface speaks for it: highlights
// leave gaps on a part that is otherwise measured well, not on one of which little is measured.
constexpr double kGapWeight = 1.5;
// What lacks support is told to be out of view where less of it than this is inside the image.
constexpr double kMostlyInView = 0.6;

}  // namespace

Result<void> judge(const Evidence& evidence, double tolerance_mm, const Requirements& required) {
  if (evidence.points < required.points) {
    return failure(ResultCode::kObjectTooSmall,
                   "only %d surface points in sight, expected at least %d; bring it into view", evidence.points,
                   required.points);
  }
  if (evidence.violated > required.violated) {
    return failure(ResultCode::kFreeSpaceViolated,
                   "%.0f %% of the pose's surface was seen to be empty, expected at most %.0f %%; a foreign object, or "
                   "a wrong template",
                   100.0 * evidence.violated, 100.0 * required.violated);
  }
  if (evidence.blemishes.seen_through_mm2 > 0.0) {
    return failure(ResultCode::kFreeSpaceViolated,
                   "%.0f mm2 of the pose's surface in one piece were seen through; a similar part, or a damaged one",
                   evidence.blemishes.seen_through_mm2);
  }
  if (evidence.blemishes.filled_mm2 > 0.0) {
    return failure(ResultCode::kResidualTooHigh,
                   "a hole of the part is filled, %.0f mm2 in one piece; a similar part, or something in the hole",
                   evidence.blemishes.filled_mm2);
  }
  if (evidence.sunk > required.sunk) {
    return failure(ResultCode::kFreeSpaceViolated,
                   "%.0f %% of the pose's surface lies under the belt, expected at most %.0f %%; too little in view to "
                   "tell how the part lies",
                   100.0 * evidence.sunk, 100.0 * required.sunk);
  }
  if (evidence.contradicted > required.contradicted) {
    return failure(ResultCode::kResidualTooHigh,
                   "%.0f %% of what was measured there lies off the surface, expected at most %.0f %%; a foreign or "
                   "damaged part",
                   100.0 * evidence.contradicted, 100.0 * required.contradicted);
  }
  if (evidence.unexplained > required.unexplained) {
    return failure(
        ResultCode::kResidualTooHigh,
        "the object itself hides %.0f %% of the pose, expected at most %.0f %%; there is more to it than the "
        "part",
        100.0 * evidence.unexplained, 100.0 * required.unexplained);
  }
  if (evidence.coverage < required.coverage) {
    return failure(ResultCode::kCoverageTooLow,
                   "%.0f %% of what should be visible was measured there, expected at least %.0f %%; hidden, shiny, or "
                   "a foreign object",
                   100.0 * evidence.coverage, 100.0 * required.coverage);
  }
  if (evidence.support >= required.support && evidence.support - kGapWeight * evidence.gaps < required.support) {
    return failure(
        ResultCode::kCoverageTooLow,
        "%.0f %% of the part was measured, but %.0f %% is missing that the light should have reached; shiny, "
        "or a foreign object",
        100.0 * evidence.support, 100.0 * evidence.gaps);
  }
  if (evidence.support < required.support && evidence.in_view < kMostlyInView) {
    return failure(
        ResultCode::kPartlyOutOfView,
        "only %.0f %% of the part was measured, expected at least %.0f %%: %.0f %% of it is inside the image; "
        "it is seen whole on its next lap",
        100.0 * evidence.support, 100.0 * required.support, 100.0 * evidence.in_view);
  }
  if (evidence.support < required.support) {
    return failure(ResultCode::kCoverageTooLow,
                   "only %.0f %% of the part was measured, expected at least %.0f %%; most of it is hidden",
                   100.0 * evidence.support, 100.0 * required.support);
  }
  if (evidence.continued > required.continued) {
    return failure(
        ResultCode::kResidualTooHigh,
        "along %.0f %% of the outline the object goes on, expected at most %.0f %%; a larger, foreign object",
        100.0 * evidence.continued, 100.0 * required.continued);
  }
  if (evidence.rms_mm > required.residual * tolerance_mm) {
    return failure(ResultCode::kResidualTooHigh, "%.3f mm RMS to the surface, expected at most %.3f; a damaged part?",
                   evidence.rms_mm, required.residual * tolerance_mm);
  }
  return {};
}

double score(const Evidence& evidence) {
  const double value = evidence.coverage * (1.0 - evidence.contradicted) * (1.0 - 4.0 * evidence.violated) *
                       (1.0 - 0.5 * evidence.continued);
  return std::clamp(value, 0.0, 1.0);
}

}  // namespace beltpick::result
