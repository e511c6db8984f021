#include "bench/pose/peers/pcl_peer.hpp"

#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

namespace beltpick::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;

constexpr int kIterations = 50;
constexpr double kWideShare = 0.08;  // of the part's diagonal
constexpr double kNarrowMm = 3.0;

void add(Cloud& cloud, const Vec3f& at, const Vec3f& normal) {
  pcl::PointNormal point;
  point.getVector3fMap() = at;
  point.getNormalVector3fMap() = normal;
  cloud.push_back(point);
}

PeerFit fit(const Cloud::Ptr& target, const PeerObject& object, const PartPose& start) {
  const auto T_part_camera = start.inverse();
  const Cloud::Ptr source(new Cloud);
  for (const OrientedPoint& point : object.sample) {
    add(*source, (T_part_camera * point.point_mm.cast<double>()).cast<float>(),
        (T_part_camera.rotation * point.normal.cast<double>()).cast<float>());
  }
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setInputSource(source);
  icp.setInputTarget(target);
  icp.setMaximumIterations(kIterations);
  icp.setTransformationEpsilon(1e-10);
  Eigen::Matrix4f moved = Eigen::Matrix4f::Identity();
  const double diagonal_mm = (object.part->box_max_mm - object.part->box_min_mm).norm();
  Cloud aligned;
  for (const double radius_mm : {kWideShare * diagonal_mm, kNarrowMm}) {
    icp.setMaxCorrespondenceDistance(radius_mm);
    icp.align(aligned, moved);
    moved = icp.getFinalTransformation();
  }
  const auto refined = Pose<frame::Part, frame::Part>::from_matrix(moved.cast<double>()) * T_part_camera;
  return {refined.inverse(), icp.getFitnessScore()};
}

}  // namespace

PeerFit pcl_icp(const PeerObject& object) {
  const Cloud::Ptr target(new Cloud);
  for (std::size_t i = 0; i < object.part->point_mm.size(); ++i)
    add(*target, object.part->point_mm[i], object.part->normal[i]);
  PeerFit best;
  for (const PartPose& start : object.starts) {
    const PeerFit found = fit(target, object, start);
    if (found.distance < best.distance) best = found;
  }
  return best;
}

}  // namespace beltpick::bench
