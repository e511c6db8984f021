// How true a measured cloud is to surfaces of known shape: planes, balls and the steps of a wedge.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image.hpp"
#include "base/pose.hpp"
#include "contract/truth.hpp"

namespace beltpick::bench {

// The measured points of one target, away from its edges, with the pixels that they belong to.
struct TargetPoints {
  std::vector<Vec3> point_mm;
  std::vector<int> row, col;
};

// Points of the pixels that show `instance` and whose neighbours within `edge_px` do too.
TargetPoints points_of(ImageView<const float> xyz, ImageView<const std::uint16_t> instances, int instance, int edge_px);

struct PlaneTrueness {
  double low_pass_rms_mm = 0.0;  // means of blocks of pixels against the plane through all points
  double low_pass_max_mm = 0.0;
  double noise_rms_mm = 0.0;  // points about their block's mean
  int blocks = 0;
};
// Blocks of `block_px` pixels a side, those with at least half their points.
PlaneTrueness judge_plane(const TargetPoints& points, int block_px);

struct Ball {
  Vec3 centre_mm = Vec3::Zero();
  double radius_mm = 0.0;
  double rms_mm = 0.0;
};
// Least squares of distances to the surface, points farther than three times the rms left out. `start_mm`: a centre to
// start from. Points whose line of sight meets the surface at more than `max_incidence_deg` are left out.
Ball fit_ball(const TargetPoints& points, const Vec3& start_mm, double max_incidence_deg);

// Heights of planes with one common normal above the first of them, mm, towards the camera.
std::vector<double> step_heights_mm(const std::vector<TargetPoints>& steps);

}  // namespace beltpick::bench
