#include "scans/pair_features.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "base/units.hpp"

namespace beltpick::scans {
namespace {

constexpr double kThinShare = 0.03;  // distance of the points that form pairs, of the part's size
constexpr double kDistanceStepShare = 0.04;
constexpr int kDistanceSteps = 26;
constexpr int kAngleSteps = 12;  // of half a turn
constexpr int kTurns = 30;       // of the whole turn about a normal
constexpr double kNearestShare = 0.12;
constexpr std::size_t kReferences = 140;
constexpr int kPeaks = 4;  // of one reference point
constexpr double kSameRotation = 0.2;
constexpr double kSameTranslationShare = 0.05;
constexpr std::uint32_t kKeys = static_cast<std::uint32_t>(kDistanceSteps) * kAngleSteps * kAngleSteps * kAngleSteps;

int angle_step(float cosine) {
  const float angle = std::acos(std::clamp(cosine, -1.0F, 1.0F));
  return std::min(kAngleSteps - 1, static_cast<int>(angle * static_cast<float>(kAngleSteps / kPi)));
}

// Takes the point to the origin and its normal to +x.
Pose<frame::Part, frame::Camera> upright(const OrientedPoint& reference) {
  const Vec3 normal = reference.normal.cast<double>();
  const Mat3 rotation = Eigen::Quaterniond::FromTwoVectors(normal, Vec3::UnitX()).toRotationMatrix();
  return {rotation, -(rotation * reference.point_mm.cast<double>())};
}

float angle_about_normal(const OrientedPoint& reference, const OrientedPoint& other) {
  const Vec3 at = upright(reference) * other.point_mm.cast<double>();
  return static_cast<float>(std::atan2(at.z(), at.y()));
}

}  // namespace

PairTable::PairTable(const ScanView& model, double size_mm) : size_mm_(size_mm), points_(thin(model)) {
  std::vector<std::pair<std::uint32_t, Entry>> found;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    for (std::size_t j = 0; j < points_.size(); ++j) {
      Feature pair{};
      if (i != j && feature(points_[i], points_[j], pair))
        found.push_back({pair.key, {static_cast<std::uint16_t>(i), pair.angle}});
    }
  }
  first_.assign(kKeys + 1, 0);
  for (const auto& [key, entry] : found) ++first_[key + 1];
  for (std::size_t key = 0; key < kKeys; ++key) first_[key + 1] += first_[key];
  entries_.resize(found.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& [key, entry] : found) entries_[next[key]++] = entry;
}

// One point in each cell of a coarse lattice.
PairTable::Points PairTable::thin(const ScanView& view) const {
  Points kept;
  std::unordered_set<std::int64_t> taken;
  const auto cell = static_cast<float>(kThinShare * size_mm_);
  for (const OrientedPoint& point : view.point) {
    const Eigen::Vector3i at = (point.point_mm / cell).array().floor().cast<int>();
    const std::int64_t key = (static_cast<std::int64_t>(at.x()) * 100003 + at.y()) * 100003 + at.z();
    if (taken.insert(key).second) kept.push_back(point);
  }
  return kept;
}

// Pairs on one plane look alike everywhere and tell nothing.
bool PairTable::feature(const OrientedPoint& reference, const OrientedPoint& other, Feature& out) const {
  const Vec3f apart = other.point_mm - reference.point_mm;
  const float distance = apart.norm();
  if (static_cast<double>(distance) < kNearestShare * size_mm_) return false;
  const int step = static_cast<int>(static_cast<double>(distance) / (kDistanceStepShare * size_mm_));
  if (step >= kDistanceSteps) return false;
  const Vec3f along = apart / distance;
  const float one = reference.normal.dot(along);
  const float two = other.normal.dot(along);
  const float both = reference.normal.dot(other.normal);
  if (both > 0.96F && std::abs(one) < 0.2F) return false;
  out.key =
      ((static_cast<std::uint32_t>(step) * kAngleSteps + static_cast<std::uint32_t>(angle_step(one))) * kAngleSteps +
       static_cast<std::uint32_t>(angle_step(two))) *
          kAngleSteps +
      static_cast<std::uint32_t>(angle_step(both));
  out.angle = angle_about_normal(reference, other);
  return true;
}

void PairTable::vote_of_reference(const Points& points, std::size_t reference, std::vector<std::uint16_t>& votes,
                                  std::vector<VotedPose>& out) const {
  std::fill(votes.begin(), votes.end(), std::uint16_t{0});
  for (std::size_t j = 0; j < points.size(); ++j) {
    Feature pair{};
    if (j == reference || !feature(points[reference], points[j], pair)) continue;
    for (std::uint32_t e = first_[pair.key]; e < first_[pair.key + 1]; ++e) {
      const double turn = (static_cast<double>(entries_[e].angle - pair.angle) / (2.0 * kPi) + 2.0) * kTurns;
      ++votes[entries_[e].reference * static_cast<std::size_t>(kTurns) +
              static_cast<std::size_t>(turn) % static_cast<std::size_t>(kTurns)];
    }
  }
  const auto scan_upright = upright(points[reference]);
  for (int peak = 0; peak < kPeaks; ++peak) {
    const auto best = std::max_element(votes.begin(), votes.end());
    if (*best == 0) return;
    const auto at = static_cast<std::size_t>(best - votes.begin());
    const double turn = (static_cast<double>(at % kTurns) + 0.5) * 2.0 * kPi / kTurns;
    const Pose<frame::Part, frame::Part> about{Eigen::AngleAxisd(turn, Vec3::UnitX()).toRotationMatrix(), Vec3::Zero()};
    out.push_back({upright(points_[at / kTurns]).inverse() * (about * scan_upright), *best});
    *best = 0;
  }
}

std::vector<VotedPose> PairTable::vote(const ScanView& scan, std::size_t most) const {
  const Points points = thin(scan);
  std::vector<std::uint16_t> votes(points_.size() * kTurns);
  std::vector<VotedPose> raw;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kReferences);
  for (std::size_t i = 0; i < points.size(); i += step) vote_of_reference(points, i, votes, raw);
  std::stable_sort(raw.begin(), raw.end(), [](const VotedPose& a, const VotedPose& b) { return a.votes > b.votes; });
  std::vector<VotedPose> distinct;
  const Vec3 middle = points.empty() ? Vec3(Vec3::Zero()) : points[points.size() / 2].point_mm.cast<double>();
  for (const VotedPose& pose : raw) {
    // References that vote for the same pose strengthen it.
    const auto same = std::find_if(distinct.begin(), distinct.end(), [&](const VotedPose& other) {
      return (pose.T_model_scan * middle - other.T_model_scan * middle).norm() < kSameTranslationShare * size_mm_ &&
             rotation_between_rad(pose.T_model_scan.rotation, other.T_model_scan.rotation) < kSameRotation;
    });
    if (same == distinct.end()) {
      distinct.push_back(pose);
    } else {
      same->votes += pose.votes;
    }
  }
  std::stable_sort(distinct.begin(), distinct.end(),
                   [](const VotedPose& a, const VotedPose& b) { return a.votes > b.votes; });
  if (distinct.size() > most) distinct.resize(most);
  return distinct;
}

}  // namespace beltpick::scans
