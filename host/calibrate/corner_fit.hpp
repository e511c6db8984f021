// A printed corner to a hundredth of a pixel: four squares and the camera's blur, fitted to the image round it.
#pragma once

#include <optional>

#include "base/image.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::calibrate {

// Where two straight edges of a chessboard cross, near `start`, from the pixels within `radius_px`:
//   level = (a + b erf(d1 / s) erf(d2 / s)) (1 + g . x)
// with d1, d2 the distances to the edges, s the blur and g the light's slope. Unlike the usual search for gradients
// square to the way to the corner it has no error that depends on where the corner lies between pixels. Nothing where
// it does not converge, or ends over 1.5 pixels from `start`.
std::optional<PixelPosition> fit_corner(ImageView<const float> image, const PixelPosition& start, double radius_px);

}  // namespace beltpick::calibrate
