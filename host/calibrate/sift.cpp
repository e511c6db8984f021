#include "calibrate/sift.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace beltpick::calibrate {
namespace {

constexpr int kLeastCorners = 12;
constexpr double kRayleighMedian = 1.1774;  // of a 2-D residual, over the standard deviation of one coordinate
constexpr double kNoiseFloor_px = 0.01;     // below it lie the errors of the lens model, which are no noise
constexpr double kOutlier = 6.0;            // standard deviations; noise alone reaches it once in 60 million corners
constexpr double kHarmless_px = 0.15;  // no outlier: where lenses have more terms than the model it is off by as much
constexpr double kPoseOutlier = 4.0;   // times the other poses' typical residual
constexpr double kMaxLostShare = 0.25;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Sizes {
  std::vector<double> camera_px, projector_px;
};

Sizes sizes_in(const Observations& seen, const Selection& use, const BundleState& state, std::size_t pose) {
  Sizes sizes;
  for (std::size_t i = 0; i < seen.poses[pose].corners.size(); ++i) {
    if (!use.corner[pose][i]) continue;
    const BundleResidual residual = residual_of(seen, state, pose, i);
    sizes.camera_px.push_back(residual.camera_px.norm());
    if (use.projector[pose][i]) sizes.projector_px.push_back(residual.projector_px.norm());
  }
  return sizes;
}

std::string text(const char* format, double a, double b) {
  char line[200];
  std::snprintf(line, sizeof line, format, a, b);
  return line;
}

}  // namespace

int count_poses(const Selection& use) { return static_cast<int>(std::count(use.pose.begin(), use.pose.end(), true)); }

Selection select_all(const Observations& seen, std::vector<LeftOut>& left_out) {
  Selection use;
  for (const ObservedPose& pose : seen.poses) {
    std::vector<bool> lit;
    for (const ObservedCorner& corner : pose.corners) {
      lit.push_back(corner.has_projector());
      if (!corner.has_projector()) left_out.push_back({pose.capture, corner.corner, corner.no_projector_reason});
    }
    const auto count = std::count(lit.begin(), lit.end(), true);
    const bool enough = count >= kLeastCorners;
    if (!enough) {
      left_out.push_back(
          {pose.capture, -1,
           text("the projector lights %.0f of its %.0f corners measurably; keep the whole plate in its light",
                static_cast<double>(count), static_cast<double>(lit.size()))});
    }
    use.pose.push_back(enough);
    use.corner.emplace_back(pose.corners.size(), true);
    use.projector.push_back(std::move(lit));
  }
  return use;
}

BundleNoise noise_of(const Observations& seen, const Selection& use, const BundleState& state) {
  Sizes all;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    const Sizes sizes = sizes_in(seen, use, state, p);
    all.camera_px.insert(all.camera_px.end(), sizes.camera_px.begin(), sizes.camera_px.end());
    all.projector_px.insert(all.projector_px.end(), sizes.projector_px.begin(), sizes.projector_px.end());
  }
  return {std::max(median(all.camera_px) / kRayleighMedian, kNoiseFloor_px),
          std::max(median(all.projector_px) / kRayleighMedian, kNoiseFloor_px)};
}

bool leave_out_pose(const Observations& seen, const BundleState& state, double worst_px, Selection& use,
                    std::vector<LeftOut>& left_out) {
  std::vector<double> camera_px(seen.poses.size(), 0.0), projector_px(seen.poses.size(), 0.0), all_camera,
      all_projector;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    const Sizes sizes = sizes_in(seen, use, state, p);
    all_camera.push_back(camera_px[p] = median(sizes.camera_px));
    all_projector.push_back(projector_px[p] = median(sizes.projector_px));
  }
  const double camera_limit = std::max(worst_px, kPoseOutlier * median(all_camera));
  const double projector_limit = std::max(worst_px, kPoseOutlier * median(all_projector));
  std::size_t worst = 0;
  double badness = 1.0;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    const double here = std::max(camera_px[p] / camera_limit, projector_px[p] / projector_limit);
    if (here > badness) {
      badness = here;
      worst = p;
    }
  }
  if (badness <= 1.0) return false;
  use.pose[worst] = false;
  const double residual_px = std::max(camera_px[worst], projector_px[worst]);
  left_out.push_back(
      {seen.poses[worst].capture, -1,
       text("its corners are typically %.2f px off in the camera and %.2f px in the projector, far more than in the "
            "other captures: did the plate move, or was another plate held?",
            camera_px[worst], projector_px[worst]),
       residual_px});
  return true;
}

bool leave_out_corners(const Observations& seen, const BundleState& state, const BundleNoise& noise, Selection& use,
                       std::vector<LeftOut>& left_out) {
  const Selection before = use;
  std::erase_if(left_out, [](const LeftOut& item) { return item.corner >= 0 && item.residual_px > 0.0; });
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    const ObservedPose& pose = seen.poses[p];
    std::vector<LeftOut> lost;
    for (std::size_t i = 0; i < pose.corners.size(); ++i) {
      const BundleResidual residual = residual_of(seen, state, p, i);
      const double camera_px = residual.camera_px.norm();
      const double projector_px = pose.corners[i].has_projector() ? residual.projector_px.norm() : 0.0;
      const bool camera_good = camera_px <= std::max(kHarmless_px, kOutlier * noise.camera_px);
      const bool projector_good = projector_px <= std::max(kHarmless_px, kOutlier * noise.projector_px);
      use.corner[p][i] = camera_good;
      use.projector[p][i] = pose.corners[i].has_projector() && projector_good;
      if (!camera_good) {
        lost.push_back({pose.capture, pose.corners[i].corner,
                        text("%.2f px off in the camera image, the noise is %.3f px", camera_px, noise.camera_px),
                        camera_px});
      } else if (!projector_good) {
        lost.push_back({pose.capture, pose.corners[i].corner,
                        text("%.2f px off in the projector, the noise is %.3f px", projector_px, noise.projector_px),
                        projector_px});
      }
    }
    if (static_cast<double>(lost.size()) > kMaxLostShare * static_cast<double>(pose.corners.size())) {
      use.pose[p] = false;
      left_out.push_back({pose.capture, -1,
                          text("%.0f of its %.0f corners do not fit: did the plate move, or was it out of focus?",
                               static_cast<double>(lost.size()), static_cast<double>(pose.corners.size())),
                          lost.front().residual_px});
    } else {
      left_out.insert(left_out.end(), lost.begin(), lost.end());
    }
  }
  return use.pose != before.pose || use.corner != before.corner || use.projector != before.projector;
}

}  // namespace beltpick::calibrate
