// The verdict on a pose from its evidence: verified, or withheld with the reason.
#pragma once

#include "base/result.hpp"
#include "contract/requirements.hpp"
#include "result/evidence.hpp"

namespace beltpick::result {

// Ok, or the reason as it goes into result.json. Errors: kPartlyOutOfView, kFreeSpaceViolated, kCoverageTooLow,
// kResidualTooHigh, kObjectTooSmall.
Result<void> judge(const Evidence& evidence, double tolerance_mm, const Requirements& required);

// 0..1: how much speaks for the pose; orders rivals and the picks of one height.
double score(const Evidence& evidence);

}  // namespace beltpick::result
