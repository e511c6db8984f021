#include "bench/pose/peers/opencv_peer.hpp"

#include <opencv2/core.hpp>
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/ppf_helpers.hpp>

namespace beltpick::bench {
namespace {

// Those of the example in its own documentation; steps in shares of the part's diameter. Finer sampling (0.04) makes
// training take minutes a part.
constexpr double kSamplingStep = 0.06, kDistanceStep = 0.06;
constexpr double kSceneStep = 1.0 / 5.0, kSceneDistance = 0.06;
constexpr int kIcpIterations = 100;
constexpr float kIcpTolerance = 0.005F, kIcpReject = 2.5F;
constexpr int kIcpLevels = 8;

void put(cv::Mat& cloud, int row, const Vec3f& at, const Vec3f& normal) {
  for (int i = 0; i < 3; ++i) cloud.at<float>(row, i) = at[i], cloud.at<float>(row, 3 + i) = normal[i];
}

cv::Mat cloud_of(const PeerObject& object) {
  cv::Mat cloud(static_cast<int>(object.sample.size()), 6, CV_32F);
  for (std::size_t i = 0; i < object.sample.size(); ++i)
    put(cloud, static_cast<int>(i), object.sample[i].point_mm, object.sample[i].normal);
  return cloud;
}

PartPose pose_of(const cv::ppf_match_3d::Pose3D& result) {
  Mat4 pose;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) pose(row, col) = result.pose(row, col);
  }
  return PartPose::from_matrix(pose);
}

}  // namespace

struct OpencvPpf::State {
  cv::Mat model;
  cv::ppf_match_3d::PPF3DDetector detector{kSamplingStep, kDistanceStep};
};

OpencvPpf::OpencvPpf(const PartTemplate& part) : state_(std::make_unique<State>()) {
  state_->model.create(static_cast<int>(part.point_mm.size()), 6, CV_32F);
  for (std::size_t i = 0; i < part.point_mm.size(); ++i)
    put(state_->model, static_cast<int>(i), part.point_mm[i], part.normal[i]);
}
OpencvPpf::~OpencvPpf() = default;
OpencvPpf::OpencvPpf(OpencvPpf&&) noexcept = default;

void OpencvPpf::train() { state_->detector.trainModel(state_->model); }

std::vector<PartPose> OpencvPpf::propose(const PeerObject& object, std::size_t most) const {
  std::vector<cv::ppf_match_3d::Pose3DPtr> results;
  state_->detector.match(cloud_of(object), results, kSceneStep, kSceneDistance);
  results.resize(std::min(most, results.size()));
  std::vector<PartPose> poses;
  for (const auto& result : results) poses.push_back(pose_of(*result));
  return poses;
}

PeerFit OpencvPpf::refine(const PeerObject& object, const std::vector<PartPose>& poses) const {
  std::vector<cv::ppf_match_3d::Pose3DPtr> fits;
  for (const PartPose& pose : poses) {
    const Mat4 matrix = pose.matrix();
    cv::Matx44d start;
    for (int row = 0; row < 4; ++row) {
      for (int col = 0; col < 4; ++col) start(row, col) = matrix(row, col);
    }
    fits.push_back(cv::makePtr<cv::ppf_match_3d::Pose3D>());
    fits.back()->updatePose(start);
  }
  cv::ppf_match_3d::ICP icp(kIcpIterations, kIcpTolerance, kIcpReject, kIcpLevels);
  icp.registerModelToScene(state_->model, cloud_of(object), fits);
  const auto least =
      std::min_element(fits.begin(), fits.end(), [](auto& a, auto& b) { return a->residual < b->residual; });
  return {pose_of(**least), (*least)->residual};
}

}  // namespace beltpick::bench
