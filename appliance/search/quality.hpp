// Q(P, M): how well a sample of an object lies on a part in an assumed pose: the paper's equation (6).
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "base/point_block.hpp"
#include "base/pose.hpp"
#include "contract/find_nearest.hpp"
#include "contract/part_model.hpp"

namespace beltpick::search {

using PartPose = Pose<frame::Camera, frame::Part>;

// The points that hypotheses are tried with, camera frame; in portions, after each of which a hypothesis may be given
// up.
class SearchSample {
 public:
  static constexpr int kMost = 128;  // a sample that is larger is used up to here: any first part of it is one too
  static constexpr int kPortion = 32;

  explicit SearchSample(std::span<const OrientedPoint> points);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int portions() const { return (count_ + kPortion - 1) / kPortion; }
  [[nodiscard]] const PointBlock& portion(int i) const { return blocks_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int count_of(int portion) const { return std::min(kPortion, count_ - portion * kPortion); }
  [[nodiscard]] const Vec3& centroid_mm() const { return centroid_mm_; }

 private:
  std::array<PointBlock, kMost / kPortion> blocks_;
  int count_ = 0;
  Vec3 centroid_mm_ = Vec3::Zero();
};

// The mean over the sample of the distance to the nearest point of the part, in mm, each distance capped at `cap_mm` so
// that points of something else do not decide; a point whose nearest surface faces the other way counts as capped.
// Gives up, returning more than `give_up_mm`, once the mean is sure to exceed that.
float mean_distance_mm(const SearchSample& sample, const PartModel& model, const PartPose& T_camera_part, float cap_mm,
                       float give_up_mm);

// The same in three steps, so that whoever tries several poses at once need not wait for each one's memory: begin() and
// go_on() tell the memory what the next step will read. All three must be given the same sample and model.
class QualityQuery {
 public:
  void begin(const SearchSample& sample, const PartModel& model, const PartPose& T_camera_part);
  void go_on(const SearchSample& sample, const PartModel& model);
  float finish(const SearchSample& sample, const PartModel& model, float cap_mm, float give_up_mm);

 private:
  FastMotion into_part_{PartPose{}};
  PointBlock at_;  // the portion
  NearestQuery nearest_;
};

}  // namespace beltpick::search
