// How firmly what was measured holds a pose, by the covariance of its alignment.
#pragma once

#include <optional>
#include <span>

#include "base/stages.hpp"
#include "contract/part_model.hpp"
#include "icp/align.hpp"
#include "result/scene.hpp"

namespace beltpick::pipeline {

// A small motion in the camera frame about the centre of the part's box, as Alignment::covariance has it: a rotation
// vector in rad, then a translation in mm.
using Motion = Eigen::Matrix<double, 6, 1>;

// Whether surface and outline hold the part well enough to grip it (1 mm, 1 degree), but for turns that its symmetry
// makes no difference of.
bool determined(const Alignment& alignment, const PartModel& model);

// The motion that is held least, scaled so that the part's rim (half its diagonal) moves by 1 mm; turns that the
// symmetry makes no difference of do not count. Nothing where all are held firmly.
std::optional<Motion> loosest_freedom(const Alignment& alignment, const PartModel& model);

// Whether little but the outline holds the part in two freedoms or more. A part that slides one way alone is told by
// `determined`; one that may also slide or turn another way is held by the ends all round alone, and wrongly where many
// of them are those of shadows.
bool held_by_outline(const Alignment& alignment, const PartModel& model);

// How far, in mm at the part's rim, `ends` ask the pose to move along those freedoms; 0 where the surface holds the
// part.
double asked_shift_mm(const Alignment& alignment, const PartModel& model, std::span<const icp::OutlinePair> ends);

// The covariance of `other`, a pose that looks the same, from that of `pose`: it counts motions about another centre.
Eigen::Matrix<double, 6, 6> covariance_of_equivalent(const result::PartPose& other, const result::PartPose& pose,
                                                     const PartModel& model,
                                                     const Eigen::Matrix<double, 6, 6>& covariance);

// Makes the covariance of a pose tell that the turns which the part's symmetry leaves free are not known.
void spread_free_turns(Eigen::Matrix<double, 6, 6>& covariance, const result::PartPose& T_camera_part,
                       const PartModel& model);

// The pose after the motion.
result::PartPose moved(const result::PartPose& T_camera_part, const Motion& motion, const PartModel& model);

}  // namespace beltpick::pipeline
