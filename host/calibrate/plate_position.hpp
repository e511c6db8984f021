// Where the calibration plate lies: its frame's origin at its first inner corner, x along its columns, y along its
// rows, z into it. frame::Part stands for the plate.
#pragma once

#include "base/pose.hpp"

namespace beltpick::calibrate {

using PlatePosition = Pose<frame::Camera, frame::Part>;

}  // namespace beltpick::calibrate
