// The belt's frame: from the plane of a bare belt, or from the calibration plate lying on it.
#pragma once

#include <optional>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "calibrate/plate_position.hpp"
#include "contract/calibration.hpp"

namespace beltpick::calibrate {

using BeltPose = Pose<frame::Belt, frame::Camera>;

struct BeltPlane {
  Plane plane;              // normal towards the camera
  double rms_mm = 0.0;      // of the points on it, weighted as they were fitted
  double bow_mm = 0.0;      // of the belt: second-order surface through it, from lowest to highest
  double inlier_share = 0;  // of all measured points
  int points = 0;           // on it
};

// The plane through what lies near `start`, by Tukey's weights over all points: objects, dirt and the belt's edge do
// not pull. Error: kTooFewPoints where fewer than a tenth of the points lie on it.
Result<BeltPlane> fit_belt_plane(const RangeImage& range, const Plane& start);

// A frame on `plane`, z up. Where `earlier` is given, its origin and x axis are kept, laid onto the plane; else the
// origin is where the camera's axis meets the belt, and x runs as the image's columns do.
BeltPose belt_frame_on(const Plane& plane, const std::optional<BeltPose>& earlier);

// The frame that a plate of `thickness_mm` marks, lying face up on the belt: origin below its first inner corner, x
// along its columns, z up.
BeltPose belt_frame_from(const PlatePosition& T_camera_plate, double thickness_mm);

// The plane z = 0 of a belt frame, in the camera frame.
Plane belt_plane_of(const BeltPose& T_belt_camera);

}  // namespace beltpick::calibrate
