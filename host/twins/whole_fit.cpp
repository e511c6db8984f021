#include "twins/whole_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.hpp"
#include "base/units.hpp"
#include "icp/align.hpp"
#include "search/hypothesis_pool.hpp"
#include "search/trials.hpp"
#include "search/views.hpp"

namespace beltpick::twins {
namespace {

using Fit = Pose<frame::Camera, frame::Part>;

constexpr int kTurns = 24;
constexpr std::size_t kSearchPoints = 128;
constexpr std::size_t kAlignPoints = 2000;
constexpr std::size_t kAligned = 24;

std::vector<OrientedPoint> sample(std::span<const OrientedPoint> points, std::size_t count) {
  std::vector<OrientedPoint> chosen;
  Random random(1);
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(points[random.below(static_cast<std::uint32_t>(points.size()))]);
  return chosen;
}

Vec3 middle_of(std::span<const OrientedPoint> points) {
  Vec3 sum = Vec3::Zero();
  for (const OrientedPoint& point : points) sum += point.point_mm.cast<double>();
  return sum / static_cast<double>(points.size());
}

WholeFit measure(std::span<const OrientedPoint> points, const PartModel& other, const Fit& T_own_other,
                 double tolerance_mm) {
  WholeFit fit;
  fit.T_own_other = T_own_other;
  const auto T_other_own = T_own_other.inverse();
  std::size_t differing = 0;
  for (const OrientedPoint& point : points) {
    const Vec3f at = (T_other_own * point.point_mm.cast<double>()).cast<float>();
    const OrientedPoint& nearest = other.nearest(at);
    const Vec3f apart = at - nearest.point_mm;
    const double aside = static_cast<double>(apart.norm());
    // Between the other's points only the distance to the surface through them counts.
    const double off = aside < 1.5 * static_cast<double>(other.spacing_mm) + tolerance_mm
                           ? static_cast<double>(std::abs(nearest.normal.dot(apart)))
                           : aside;
    differing += off > tolerance_mm ? 1 : 0;
    if (off > fit.largest_mm) fit.largest_mm = off, fit.where_mm = point.point_mm.cast<double>();
  }
  fit.differing_share = static_cast<double>(differing) / static_cast<double>(points.size());
  return fit;
}

}  // namespace

std::vector<OrientedPoint> mirrored(std::span<const OrientedPoint> points) {
  std::vector<OrientedPoint> image(points.begin(), points.end());
  for (OrientedPoint& point : image) {
    point.point_mm.x() = -point.point_mm.x();
    point.normal.x() = -point.normal.x();
  }
  return image;
}

WholeFit fit_whole(std::span<const OrientedPoint> points, const PartModel& other, double tolerance_mm) {
  const search::SearchInput input{other, search::SearchSample(sample(points, kSearchPoints)),
                                  static_cast<float>(0.1 * other.diagonal_mm)};
  const std::vector<OrientedPoint> more = sample(points, kAlignPoints);
  const Vec3 own_middle = middle_of(points);
  const Vec3 other_middle = middle_of(other.surface);
  std::vector<Hypothesis> storage(400);
  search::HypothesisPool pool(storage);
  {
    search::Trials trials(input, pool);
    for (const Vec3& direction : search::view_directions()) {
      const Mat3 first = Eigen::Quaterniond::FromTwoVectors(direction, Vec3::UnitZ()).toRotationMatrix();
      for (int turn = 0; turn < kTurns; ++turn) {
        const Mat3 rotation = Eigen::AngleAxisd(2.0 * kPi * turn / kTurns, Vec3::UnitZ()).toRotationMatrix() * first;
        trials.add({rotation, own_middle - rotation * other_middle});
      }
    }
  }
  std::array<Hypothesis, kAligned> best;
  const std::size_t count = pool.take_distinct(other, 0.04 * other.diagonal_mm, rad_from_deg(12.0), best);
  const std::array<icp::Stage, 3> stages{icp::Stage{0.06 * other.diagonal_mm, 10, 0.3F},
                                         icp::Stage{0.025 * other.diagonal_mm, 12, 0.5F},
                                         icp::Stage{std::max(1.0, 3.0 * tolerance_mm), 15, 0.7F}};
  WholeFit closest;
  closest.largest_mm = other.diagonal_mm;
  for (std::size_t i = 0; i < count; ++i) {
    const Alignment aligned = icp::align(more, other, best[i].T_camera_part, stages, icp::Noise{});
    const WholeFit fit = measure(points, other, aligned.T_camera_part, tolerance_mm);
    if (fit.differing_share < closest.differing_share) closest = fit;
  }
  return closest;
}

}  // namespace beltpick::twins
