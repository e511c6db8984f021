#include "search/quality.hpp"

#include <algorithm>
#include <cmath>

#include "base/kernel.hpp"

namespace beltpick::search {
namespace {

// The capped distances of the points of one portion, as sums kept apart: their order does not depend on the vector
// unit.
BELTPICK_KERNEL void add_distances(const PointBlock& at, const PointBlock& near, float cap_mm, std::size_t count,
                                   float* __restrict sums) {
  for (std::size_t i = 0; i < count; i += PointBlock::kLanes) {
    for (std::size_t lane = 0; lane < PointBlock::kLanes; ++lane) {
      const std::size_t k = i + lane;
      const float dx = near.x[k] - at.x[k], dy = near.y[k] - at.y[k], dz = near.z[k] - at.z[k];
      const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
      const float facing = near.nx[k] * at.nx[k] + near.ny[k] * at.ny[k] + near.nz[k] * at.nz[k];
      sums[lane] += facing > 0.0F && distance < cap_mm ? distance : cap_mm;
    }
  }
}

float sum_of_portion(const PointBlock& at, const PointBlock& near, float cap_mm, int count) {
  alignas(64) std::array<float, PointBlock::kLanes> sums{};
  const int whole = PointBlock::whole_steps(count);
  add_distances(at, near, cap_mm, static_cast<std::size_t>(whole), sums.data());
  float sum = 0.0F;
  for (const float of_lane : sums) sum += of_lane;
  return sum - static_cast<float>(whole - count) * cap_mm;  // what fills up the block faces nothing
}

}  // namespace

SearchSample::SearchSample(std::span<const OrientedPoint> points)
    : count_(static_cast<int>(std::min<std::size_t>(points.size(), kMost))) {
  const auto used = points.first(static_cast<std::size_t>(count_));
  for (int i = 0; i < portions(); ++i) {
    blocks_[static_cast<std::size_t>(i)].load(
        used.subspan(static_cast<std::size_t>(i * kPortion), static_cast<std::size_t>(count_of(i))));
  }
  for (const OrientedPoint& point : used) centroid_mm_ += point.point_mm.cast<double>() / count_;
}

void QualityQuery::begin(const SearchSample& sample, const PartModel& model, const PartPose& T_camera_part) {
  into_part_ = FastMotion(T_camera_part.inverse());
  move_points(sample.portion(0), into_part_, sample.count_of(0), at_);
  nearest_.begin(model, at_, sample.count_of(0));
}

void QualityQuery::go_on(const SearchSample& sample, const PartModel& model) {
  nearest_.go_on(model, sample.count_of(0));
}

float QualityQuery::finish(const SearchSample& sample, const PartModel& model, float cap_mm, float give_up_mm) {
  const float give_up_sum = give_up_mm * static_cast<float>(sample.count());
  PointBlock near;
  nearest_.finish(model, at_, sample.count_of(0), near);
  float sum = sum_of_portion(at_, near, cap_mm, sample.count_of(0));
  for (int i = 1; i < sample.portions() && sum <= give_up_sum; ++i) {
    const int count = sample.count_of(i);
    move_points(sample.portion(i), into_part_, count, at_);
    find_nearest(model, at_, count, near);
    sum += sum_of_portion(at_, near, cap_mm, count);
  }
  return sum / static_cast<float>(sample.count());
}

float mean_distance_mm(const SearchSample& sample, const PartModel& model, const PartPose& T_camera_part, float cap_mm,
                       float give_up_mm) {
  QualityQuery query;
  query.begin(sample, model, T_camera_part);
  query.go_on(sample, model);
  return query.finish(sample, model, cap_mm, give_up_mm);
}

}  // namespace beltpick::search
