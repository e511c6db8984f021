// The ways in which one scan may lie on another: found by votes, aligned, and put to the test of surface and free
// space.
#pragma once

#include <vector>

#include "scans/agreement.hpp"
#include "scans/pair_features.hpp"
#include "scans/scan_view.hpp"

namespace beltpick::scans {

struct Fit {
  CrossPose T_model_scan;
  Agreement agreement;
};

// What fits well enough to be thought about, best first; at most `most`. Empty where nothing does.
std::vector<Fit> search_pair(const ScanView& model, const PairTable& table, const ScanView& scan, std::size_t most);

// The limits by which aligned scans are judged.
AgreementLimits strict_limits(const ScanView& a, const ScanView& b);

}  // namespace beltpick::scans
