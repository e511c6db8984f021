// Iterative closest points (the paper's section 3.4), as point-to-plane on the part's closest-point index: from a rough
// pose to the final one, in stages that look less and less far.
#pragma once

#include <span>

#include "base/stages.hpp"
#include "contract/part_model.hpp"

namespace beltpick::icp {

using PartPose = Pose<frame::Camera, frame::Part>;

struct Stage {
  double radius_mm;    // pairs farther apart than this do not count (Tukey's weight falls to zero there)
  int iterations;      // at most
  float facing;        // least cosine between the measured normal and that of the nearest surface
};

// The noise of a single point for the covariance, at least this.
struct Noise {
  double sigma_mm = 0.05;
};

// Moves the pose so that the sample (camera frame, measured normals) lies on the tangent planes of the nearest surface
// points. Deterministic; allocates nothing. What the sample does not determine (a turn about the axis of a body of
// revolution) stays where it was and has a large covariance.
//
// In the result: rms_mm and inlier_share of the last stage; the covariance is that of a small motion in the camera
// frame, a rotation vector about the centre of the part's box and a translation of it.
Alignment align(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& initial,
                std::span<const Stage> stages, const Noise& noise);

}  // namespace beltpick::icp
