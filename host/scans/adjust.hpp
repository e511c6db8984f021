// Adjusts the poses of several scans to each other, all at once: point to plane, both ways between every two scans that
// overlap, so that errors do not add up round a loop.
#pragma once

#include <span>
#include <vector>

#include "scans/scan_view.hpp"

namespace beltpick::scans {

struct AdjustStage {
  double radius_mm;    // pairs farther off the surface do not count (Tukey's weight falls to zero there)
  int iterations;      // at most
  std::size_t points;  // of each scan
};

// Two scans after adjustment.
struct Tie {
  std::size_t first = 0, second = 0;
  int pairs = 0;
  double rms_mm = 0.0;  // of the distances to the surface, the noise of both included
};

// Moves all poses but the first. Pairs weigh by the noise of both their points. Deterministic. What the scans do not
// determine (turns of a body of revolution) stays as it was. Returns the ties of the last stage.
std::vector<Tie> adjust(std::span<const ScanView* const> views, std::span<ScanPose> T_part_scan,
                        std::span<const AdjustStage> stages);

}  // namespace beltpick::scans
