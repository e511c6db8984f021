// Where a calibration puts a point: a camera pixel and one projector coordinate to millimetres, one point at a time.
// For judging calibrations; the appliance's range library does the same for whole images.
#pragma once

#include <optional>

#include "base/pose.hpp"
#include "contract/calibration.hpp"
#include "contract/capture.hpp"
#include "contract/lens_project.hpp"

namespace beltpick::calibrate {

// The direction, with z = 1, in which `lens` sees a pixel, in the lens's own frame. Nothing where the distortion
// polynomial folds over before it gets there.
std::optional<Vec3> ray_of(const Lens& lens, const PixelPosition& pixel);

// The point, in the camera frame, that the camera sees at `camera_px` and that lies in the projector's column (row)
// `projector_px`. `guess_mm` is a depth to start from. Nothing where the ray runs along the plane of light, or where
// the point would lie behind a lens.
std::optional<Vec3> triangulate(const Calibration& calibration, const PixelPosition& camera_px, Axis axis,
                                double projector_px, double guess_mm);

// Depth at which the centre of the camera's image sees the centre of the projector's, in mm: about where the rig was
// aimed at. Nothing where the two do not meet in front of the rig.
std::optional<double> crossing_depth_mm(const Calibration& calibration);

// The projector axis along which the rig measures depth: that of its baseline.
Axis sensitive_axis(const Calibration& calibration);

// Whether a pixel lies on the lens's image.
bool on_image(const Lens& lens, const PixelPosition& pixel);

}  // namespace beltpick::calibrate
