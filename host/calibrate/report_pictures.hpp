// The pictures of a calibration's report.
#pragma once

#include "calibrate/outcome.hpp"
#include "html/page.hpp"

namespace beltpick::calibrate {

enum class Side { kCamera, kProjector };

// Where corners lay in the image, by their distance; fields without any are tinted, left-out corners are rings.
html::Figure coverage_picture(const Outcome& outcome, Side side);
// How many corners lay how far away.
html::Figure depth_picture(const Outcome& outcome);
// How the plate was tilted in each capture.
html::Figure tilt_picture(const Outcome& outcome);
// What each corner is off by, as arrows, enlarged.
html::Figure residual_arrows(const Outcome& outcome, Side side);
// The mean of it by field of the image: what no noise explains.
html::Figure residual_means(const Outcome& outcome, Side side);
// What each capture is off by: in the camera, in the projector, between both.
html::Figure residual_by_pose(const Outcome& outcome);
// What each capture is off by when it was held out, in mm.
html::Figure held_out_by_pose(const Outcome& outcome);
// How far the plate is from flat.
html::Figure plate_picture(const Outcome& outcome);

}  // namespace beltpick::calibrate
