// How well two scans fit each other in an assumed relative pose: what of each lies on the other, and what the other's
// camera saw to be empty.
#pragma once

#include "scans/scan_view.hpp"

namespace beltpick::scans {

// Shares of the scan's points that were looked up.
struct Agreement {
  double agreeing = 0.0;       // lies on the other's surface, facing the same way
  double contradicting = 0.0;  // stands in free space of the other, or under its belt
};

struct AgreementLimits {
  double surface_mm = 1.0;  // how far off the surface still agrees
  double space_mm = 1.5;    // how far into free space, or under the belt, contradicts
  std::size_t points = 500;
};

// Looks the first points of `scan` up in `other`; T_other_scan takes scan points to the camera of `other`.
Agreement look_up(const ScanView& scan, const ScanView& other, const CrossPose& T_other_scan,
                  const AgreementLimits& limits);

// Both ways: the mean of what agrees, the larger share that contradicts.
Agreement mutual(const ScanView& a, const ScanView& b, const CrossPose& T_a_b, const AgreementLimits& limits);

// What a pose gains: agreement, less what contradicts, which wrong poses can hardly avoid.
double merit(const Agreement& agreement);

}  // namespace beltpick::scans
