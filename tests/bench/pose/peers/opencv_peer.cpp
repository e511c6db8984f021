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

PeerFit OpencvPpf::match(const PeerObject& object) const {
  cv::Mat scene(static_cast<int>(object.sample.size()), 6, CV_32F);
  for (std::size_t i = 0; i < object.sample.size(); ++i)
    put(scene, static_cast<int>(i), object.sample[i].point_mm, object.sample[i].normal);
  std::vector<cv::ppf_match_3d::Pose3DPtr> results;
  state_->detector.match(scene, results, kSceneStep, kSceneDistance);
  if (results.empty()) return {};
  std::vector<cv::ppf_match_3d::Pose3DPtr> best(results.begin(),
                                                results.begin() + std::min<std::ptrdiff_t>(5, std::ssize(results)));
  cv::ppf_match_3d::ICP icp(kIcpIterations, kIcpTolerance, kIcpReject, kIcpLevels);
  icp.registerModelToScene(state_->model, scene, best);
  const auto least =
      std::min_element(best.begin(), best.end(), [](auto& a, auto& b) { return a->residual < b->residual; });
  Mat4 pose;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) pose(row, col) = (*least)->pose(row, col);
  }
  return {PartPose::from_matrix(pose), (*least)->residual};
}

}  // namespace beltpick::bench
