// Where the projector's light stands at a printed corner: the projector coordinates of the pixels round it, fitted.
#pragma once

#include <string>

#include "base/stages.hpp"
#include "calibrate/observations.hpp"

namespace beltpick::calibrate {

// Fills projector_px, projector_by_camera and projector_sigma_px of `corner`, or no_projector_reason, from the code
// round corner.camera_px. A second-order polynomial of the camera pixel for each axis, by Tukey's weights over the
// predicted noise: on a plane that is as good as a homography, over so small a window that the lens's distortion
// passes for part of it. Pixels that see an edge of the print are left out: they mix the light of two places of unequal
// brightness. `flat` is the scene under even light, 0..255; `spacing_px` the distance to the neighbouring corner.
void fit_projector_corner(const CodeImage& code, ImageView<const float> flat, double spacing_px,
                          ObservedCorner& corner);

}  // namespace beltpick::calibrate
