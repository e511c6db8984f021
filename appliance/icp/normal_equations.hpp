// The weighted least-squares system of one point-to-plane step.
#pragma once

#include <span>

#include "base/stages.hpp"
#include "contract/part_model.hpp"
#include "icp/align.hpp"

namespace beltpick::icp {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

// Unknown: a small motion of the measured points in the part frame, (rotation about model.centre_mm, translation).
struct NormalEquations {
  Mat6 information = Mat6::Zero();  // sum of w J^T J; only the lower triangle while adding up
  Vec6 gradient = Vec6::Zero();     // sum of w J^T r
  double weight = 0.0;
  double weighted_square = 0.0;  // sum of w r^2, of surface pairs
  int inliers = 0;
};

// Pairs every point of the sample with the nearest surface point of the part in pose `T_camera_part`.
// `outline_weight` is that of an outline pair against a surface pair.
NormalEquations linearise(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& T_camera_part,
                          const Stage& stage, std::span<const OutlinePair> outline, double outline_weight);

}  // namespace beltpick::icp
