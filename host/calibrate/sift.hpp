// Tells good observations from bad ones, and how noisy the good ones are.
#pragma once

#include <vector>

#include "calibrate/bundle.hpp"

namespace beltpick::calibrate {

// Everything that can be used at first: poses with at least twelve corners of which the projector's light is known.
// What cannot is added to `left_out`.
Selection select_all(const Observations& seen, std::vector<LeftOut>& left_out);

int count_poses(const Selection& use);

// Standard deviations of one coordinate, from the median residual of all used corners.
BundleNoise noise_of(const Observations& seen, const Selection& use, const BundleState& state);

// Leaves out the one pose that fits far worse than the others do, if there is one. `worst_px`: how large a typical
// residual may be in any case. True where it did.
bool leave_out_pose(const Observations& seen, const BundleState& state, double worst_px, Selection& use,
                    std::vector<LeftOut>& left_out);

// Leaves out corners that lie far out of the noise, and poses that lose more than a quarter of theirs by that. Takes
// back what fits by now. True where anything changed.
bool leave_out_corners(const Observations& seen, const BundleState& state, const BundleNoise& noise, Selection& use,
                       std::vector<LeftOut>& left_out);

}  // namespace beltpick::calibrate
