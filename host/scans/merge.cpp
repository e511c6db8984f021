#include "scans/merge.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace beltpick::scans {
namespace {

constexpr float kFacing = 0.75F;
constexpr int kLeastNeighbours = 5;
// Neighbours within this many point distances make a piece of surface.
constexpr double kRadiusSpacings = 2.2;
constexpr double kThinShare = 0.5;  // points kept, in point distances

struct Sample {
  Vec3f point_mm;
  Vec3f normal;
  float weight;
  std::uint8_t scan;
};

// Points by the cell of a lattice they lie in.
class Cells {
 public:
  Cells(const std::vector<Sample>& samples, float cell_mm) : samples_(samples), cell_mm_(cell_mm) {
    for (std::uint32_t i = 0; i < samples.size(); ++i) cells_[key(cell_of(samples[i].point_mm))].push_back(i);
  }

  // Visits what lies within a cell's width of the place, and some beyond.
  template <class Visit>
  void near(const Vec3f& at, const Visit& visit) const {
    const Eigen::Vector3i cell = cell_of(at);
    for (int i = 0; i < 27; ++i) {
      const auto found = cells_.find(key(cell + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (found == cells_.end()) continue;
      for (const std::uint32_t index : found->second) visit(samples_[index]);
    }
  }

 private:
  [[nodiscard]] Eigen::Vector3i cell_of(const Vec3f& at) const { return (at / cell_mm_).array().floor().cast<int>(); }
  static std::uint64_t key(const Eigen::Vector3i& cell) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1FFFFFU; };
    return part(cell.x()) | part(cell.y()) << 21U | part(cell.z()) << 42U;
  }
  const std::vector<Sample>& samples_;
  float cell_mm_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// Whether another scan's camera saw nothing where the point is said to be.
bool in_free_space(const Vec3& at_part_mm, std::size_t own, std::span<const ScanView> views,
                   std::span<const Pose<frame::Camera, frame::Part>> T_scan_part) {
  for (std::size_t other = 0; other < views.size(); ++other) {
    if (other == own) continue;
    const ScanView& view = views[other];
    const Vec3 at = T_scan_part[other] * at_part_mm;
    const double limit_mm = 0.5 + 5.0 * view.noise_mm;
    if (view.belt && view.belt->height_mm(at) < -limit_mm) return true;
    if (view.seen.in_front_mm(at) > limit_mm) return true;
  }
  return false;
}

std::vector<Sample> collect(std::span<const ScanView> views, std::span<const ScanPose> poses, std::size_t& dropped) {
  std::vector<Sample> samples;
  std::vector<Pose<frame::Camera, frame::Part>> inverse;
  for (const ScanPose& pose : poses) inverse.push_back(pose.inverse());
  for (std::size_t scan = 0; scan < views.size(); ++scan) {
    const ScanView& view = views[scan];
    for (std::size_t i = 0; i < view.point.size(); ++i) {
      const Vec3 at = poses[scan] * view.point[i].point_mm.cast<double>();
      if (in_free_space(at, scan, views, inverse)) {
        ++dropped;
        continue;
      }
      const Vec3 normal = poses[scan].rotation * view.point[i].normal.cast<double>();
      // What is seen at a slant is measured worse than its noise along the line of sight says.
      const float slant = -view.point[i].normal.dot(view.point[i].point_mm.normalized());
      const float weight = slant * slant / (view.sigma_mm[i] * view.sigma_mm[i]);
      samples.push_back({at.cast<float>(), normal.cast<float>(), weight, static_cast<std::uint8_t>(scan)});
    }
  }
  return samples;
}

// A weighted plane through what lies round a point.
class Patch {
 public:
  Patch(const Sample& middle, float radius_mm) : middle_(middle), radius_mm_(radius_mm) {}

  void add(const Sample& other) {
    const Vec3f arm = other.point_mm - middle_.point_mm;
    const float squared = arm.squaredNorm() / (radius_mm_ * radius_mm_);
    if (squared >= 1.0F || middle_.normal.dot(other.normal) < kFacing) return;
    const float weight = other.weight * (1.0F - squared) * (1.0F - squared);
    sum_ += weight * arm;
    square_.noalias() += weight * arm * arm.transpose();
    normal_ += weight * other.normal;
    weight_ += weight;
    scans_ |= 1U << other.scan;
    ++count_;
  }

  [[nodiscard]] bool fit(Vec3f& point_mm, Vec3f& normal) const {
    if (count_ < kLeastNeighbours) return false;
    const Vec3f mean = sum_ / weight_;
    const Eigen::Matrix3f spread = square_ / weight_ - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
    axes.computeDirect(spread);
    Vec3f plane = axes.eigenvectors().col(0);
    if (axes.eigenvalues()[1] < 0.05F * axes.eigenvalues()[2] || std::abs(plane.dot(normal_.normalized())) < 0.9F)
      plane = normal_.normalized();
    if (plane.dot(normal_) < 0.0F) plane = -plane;
    point_mm = middle_.point_mm + plane * plane.dot(mean);
    normal = plane;
    return true;
  }

  [[nodiscard]] std::uint32_t scans() const { return scans_; }

 private:
  const Sample& middle_;
  float radius_mm_;
  Vec3f sum_ = Vec3f::Zero(), normal_ = Vec3f::Zero();
  Eigen::Matrix3f square_ = Eigen::Matrix3f::Zero();
  float weight_ = 0.0F;
  int count_ = 0;
  std::uint32_t scans_ = 0;
};

}  // namespace

Merged merge(std::span<const ScanView> views, std::span<const ScanPose> T_part_scan) {
  Merged merged;
  const std::vector<Sample> samples = collect(views, T_part_scan, merged.dropped);
  double spacing_mm = 0.0;
  for (const ScanView& view : views) spacing_mm = std::max(spacing_mm, view.spacing_mm);
  const auto radius = static_cast<float>(kRadiusSpacings * spacing_mm);
  const Cells cells(samples, radius);
  // Where scans overlap there are more points than the surface needs.
  std::unordered_map<std::uint64_t, int> taken;
  const auto lattice = static_cast<float>(kThinShare * spacing_mm);
  merged.added.assign(views.size(), 0.0);
  double squared = 0.0;
  for (const Sample& sample : samples) {
    const Eigen::Vector3i cell = (sample.point_mm / lattice).array().floor().cast<int>();
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 19)) & 0xFFFFFU; };
    const auto side =
        static_cast<std::uint64_t>((sample.normal.x() > 0) + 2 * (sample.normal.y() > 0) + 4 * (sample.normal.z() > 0));
    if (taken[part(cell.x()) | part(cell.y()) << 20U | part(cell.z()) << 40U | side << 60U]++ > 0) continue;
    Patch patch(sample, radius);
    cells.near(sample.point_mm, [&](const Sample& other) { patch.add(other); });
    Vec3f point;
    Vec3f normal;
    if (!patch.fit(point, normal)) continue;
    squared += static_cast<double>((sample.point_mm - point).squaredNorm());
    merged.surface.vertex_mm.push_back(point);
    merged.surface.vertex_normal.push_back(normal);
    if (patch.scans() == 1U << sample.scan) merged.added[sample.scan] += 1.0;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, merged.surface.vertex_mm.size()));
  merged.noise_mm = std::sqrt(squared / count);
  for (double& share : merged.added) share /= count;
  return merged;
}

}  // namespace beltpick::scans
