// Puts all scans into one frame: of all ways in which pairs of them may fit, the combination that fits as a whole.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "base/result.hpp"
#include "scans/pair_search.hpp"
#include "scans/scan_view.hpp"

namespace beltpick::scans {

// A scan that fits almost as well in a second place, though the part looks different there.
struct SecondPlace {
  std::size_t scan = 0;
  double turned_rad = 0.0;  // from the place chosen
  double shifted_mm = 0.0;  // of the scan's middle
};

struct Joined {
  std::vector<ScanPose> T_part_scan;  // one a scan; the first one's camera is the common frame
  std::vector<SecondPlace> seconds;
};

// `done` is told after each pair of scans that was searched, and of how many. Errors: kNothingFound where a scan shares
// too little surface with the others, or contradicts them wherever it is laid; the message names it.
Result<Joined> join(const std::vector<ScanView>& views, const std::function<void(int, int)>& done);

}  // namespace beltpick::scans
