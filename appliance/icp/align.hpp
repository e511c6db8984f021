// Iterative closest points (the paper's section 3.4), as point-to-plane on the part's closest-point index: from a rough
// pose to the final one, in stages that look less and less far.
#pragma once

#include <span>

#include "base/stages.hpp"
#include "contract/part_model.hpp"

namespace beltpick::icp {

using PartPose = Pose<frame::Camera, frame::Part>;

struct Stage {
  double radius_mm;  // pairs farther apart than this do not count (Tukey's weight falls to zero there)
  int iterations;    // at most
  float facing;      // least cosine between the measured normal and that of the nearest surface
  // Weight of the distance along the surface from where the part ends to measured points beyond: lets a flat part slide
  // to where the object is. 0 for the last stage, where it would pull the part towards what touches it.
  float beyond = 0.0F;
  double settled = 1e-4;  // a step shorter than this share of the radius ends the stage
};

// A place on the part's outline as the camera sees it, and how far out the measured outline lies. Holds a part in place
// in directions in which its visible surfaces let it slide.
struct OutlinePair {
  Vec3f on_part_mm;   // part frame
  Vec3f outward;      // unit, part frame, across the line of sight
  Vec3f measured_mm;  // camera frame: moves with the measured points
};

// The noise of a single point for the covariance, at least this.
struct Noise {
  double sigma_mm = 0.05;
  double outline_sigma_mm = 0.4;  // of a place on the outline: pixels, and points that do not end on the very edge
};

// Moves the pose so that the sample (camera frame, measured normals) lies on the tangent planes of the nearest surface
// points. Deterministic; allocates nothing. What the sample does not determine (a turn about the axis of a body of
// revolution) stays where it was and has a large covariance.
//
// `outline`: taken as they are in every stage, within the stage's radius.
//
// A pose whose rotation has determinant -1, the part's mirror image, keeps it; its covariance means nothing.
//
// In the result: rms_mm and inlier_share of the last stage; the covariance is that of a small motion in the camera
// frame, a rotation vector about the centre of the part's box and a translation of it.
Alignment align(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& initial,
                std::span<const Stage> stages, const Noise& noise, std::span<const OutlinePair> outline = {});

// The same for the first of many poses, to see where they end: no outline, no covariance; rms_mm and inlier_share as
// they were before the last step.
Alignment approach(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& initial,
                   std::span<const Stage> stages);

}  // namespace beltpick::icp
