// HDR: a sequence taken again at other exposures.
#pragma once

#include <span>

#include "base/result.hpp"
#include "contract/capture.hpp"

namespace beltpick {

inline constexpr int kMaxExposures = 8;

// The frames of `sequence` once at each of `exposures_us`, all of one exposure together, in the order given; files
// 000.png, 001.png, .. The decoder merges the exposures per pixel. Errors: kUsage where the sequence tells its
// exposures itself, or two are the same.
Result<Sequence> at_exposures(const Sequence& sequence, std::span<const double> exposures_us);

}  // namespace beltpick
