// A first calibration to start the joint refinement from: the camera by Zhang's method, the projector by a direct
// linear transform.
#pragma once

#include "base/result.hpp"
#include "calibrate/bundle.hpp"

namespace beltpick::calibrate {

// Needs at least three poses. With the camera known, every corner is a known point in space, and the projector's
// matrix follows from all of them at once (Abdel-Aziz and Karara; normalised as Hartley has it), wherever its principal
// point lies: corners that do not fit are left out round by round. A flat plate, no distortion of the projector. Error:
// kCheckFailed where the poses do not determine a lens.
Result<BundleState> first_guess(const Observations& seen, const Selection& use);

// How the plates are tilted, roughly, before anything is known but the image's size: degrees between the outermost
// normals about the image's x axis and about its y axis.
struct RoughTilts {
  double about_x_deg = 0.0, about_y_deg = 0.0;
};
RoughTilts rough_tilts(const Observations& seen, const Selection& use);

}  // namespace beltpick::calibrate
