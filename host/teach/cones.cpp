#include "teach/cones.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/random.hpp"
#include "base/units.hpp"

namespace beltpick::teach {

namespace {

constexpr double kOnSurface_mm = 0.2;
constexpr double kFacing = 0.97;  // cosine between a point's normal and the cone's there
constexpr double kLeastShare = 0.01;
constexpr double kNarrowest_rad = rad_from_deg(5.0);
constexpr double kWidest_rad = rad_from_deg(80.0);
constexpr int kTriples = 800;
constexpr std::size_t kSample = 2500;
constexpr int kAttempts = 6;
constexpr std::size_t kBins = 36;    // round the axis
constexpr double kLeastRound = 0.3;  // of a full circle

struct Point {
  Vec3 at_mm;
  Vec3 normal;
  int owner = -1;  // the primitive that it lies on
};

// The cone whose tangent planes these are, by least squares: the apex lies on all planes, and the normals on a circle
// about the axis.
std::optional<TaughtCone> fit(const std::vector<Point>& points) {
  Mat3 planes = Mat3::Zero();
  Vec3 offsets = Vec3::Zero();
  Vec3 mean = Vec3::Zero();
  for (const Point& p : points) {
    planes += p.normal * p.normal.transpose();
    offsets += p.normal * p.normal.dot(p.at_mm);
    mean += p.normal / static_cast<double>(points.size());
  }
  Mat3 spread = Mat3::Zero();
  for (const Point& p : points) spread += (p.normal - mean) * (p.normal - mean).transpose();
  const Eigen::FullPivLU<Mat3> solver(planes);
  if (!solver.isInvertible() || solver.rcond() < 1e-5) return std::nullopt;
  TaughtCone cone;
  cone.apex_mm = solver.solve(offsets);
  cone.direction = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
  double ahead = 0.0;
  for (const Point& p : points) ahead += (p.at_mm - cone.apex_mm).dot(cone.direction);
  if (ahead < 0) cone.direction = -cone.direction;
  // Outward normals of a boss lean back towards the apex.
  const double sine = -mean.dot(cone.direction);
  cone.concave = sine < 0;
  cone.half_angle_rad = std::asin(std::min(1.0, std::abs(sine)));
  if (cone.half_angle_rad < kNarrowest_rad || cone.half_angle_rad > kWidest_rad) return std::nullopt;
  return cone;
}

std::vector<Point> lying_on(const TaughtCone& cone, const std::vector<Point>& points) {
  std::vector<Point> inliers;
  for (const Point& p : points) {
    if (on_cone(cone, p.at_mm, p.normal)) inliers.push_back(p);
  }
  return inliers;
}

std::optional<TaughtCone> find_one(const std::vector<Point>& points, std::size_t least, Random& random) {
  std::optional<TaughtCone> best;
  std::size_t most = least;
  const auto count = static_cast<std::uint32_t>(points.size());
  for (int trial = 0; trial < kTriples; ++trial) {
    const auto cone = fit({points[random.below(count)], points[random.below(count)], points[random.below(count)]});
    if (!cone) continue;
    const std::size_t inliers = lying_on(*cone, points).size();
    if (inliers < most) continue;
    most = inliers;
    best = cone;
  }
  for (int round = 0; best && round < 3; ++round) {
    const auto refined = fit(lying_on(*best, points));
    if (!refined || lying_on(*refined, points).size() < most) break;
    best = refined;
  }
  return best;
}

// Whether the cone goes round far enough to be one: a curved patch of something else looks like a sliver of a cone.
bool goes_round(const TaughtCone& cone, const std::vector<Point>& inliers) {
  const Vec3 u = cone.direction.unitOrthogonal();
  const Vec3 v = cone.direction.cross(u);
  std::array<int, kBins> bins{};
  for (const Point& p : inliers) {
    const Vec3 arm = p.at_mm - cone.apex_mm;
    const double turn = std::atan2(arm.dot(v), arm.dot(u)) / (2 * kPi) + 0.5;
    ++bins[std::min(kBins - 1, static_cast<std::size_t>(turn * kBins))];
  }
  const auto filled = std::count_if(bins.begin(), bins.end(), [](int count) { return count > 0; });
  return static_cast<double>(filled) >= kLeastRound * kBins;
}

// Fills where along the axis the cone lies.
void measure_extent(TaughtCone& cone, const std::vector<Point>& inliers) {
  std::vector<double> along;
  for (const Point& p : inliers) along.push_back((p.at_mm - cone.apex_mm).dot(cone.direction));
  std::sort(along.begin(), along.end());
  cone.from_mm = along[along.size() / 50];
  cone.to_mm = along[along.size() - 1 - along.size() / 50];
}

}  // namespace

bool on_cone(const TaughtCone& cone, const Vec3& point_mm, const Vec3& normal) {
  const Vec3 arm = point_mm - cone.apex_mm;
  const double along = arm.dot(cone.direction);
  const Vec3 radial = arm - along * cone.direction;
  const double radius = radial.norm();
  if (along <= 0 || radius < 1e-6) return false;
  const double cosine = std::cos(cone.half_angle_rad);
  const double sine = std::sin(cone.half_angle_rad);
  if (std::abs(radius * cosine - along * sine) > kOnSurface_mm) return false;
  const Vec3 outward = cosine / radius * radial - sine * cone.direction;
  return (cone.concave ? -outward : outward).dot(normal) > kFacing;
}

int primitive_of(const std::vector<Primitive>& primitives, const Vec3& point_mm, const Vec3& normal) {
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Primitive& p = primitives[i];
    const Vec3 arm = point_mm - p.point_mm;
    Vec3 outward = p.direction;
    double distance_mm = arm.dot(p.direction);
    if (p.kind != PrimitiveKind::kPlane) {
      const Vec3 radial = p.kind == PrimitiveKind::kCylinder ? Vec3(arm - distance_mm * p.direction) : arm;
      distance_mm = radial.norm() - p.radius_mm;
      outward = p.concave ? Vec3(-radial.normalized()) : radial.normalized();
    }
    if (std::abs(distance_mm) < kOnSurface_mm && outward.dot(normal) > 0.9) return static_cast<int>(i);
  }
  return -1;
}

std::vector<TaughtCone> find_cones(const Surface& surface, std::vector<Primitive>& primitives, std::uint64_t seed) {
  std::vector<Point> left;
  std::vector<double> points(primitives.size(), 0.0);  // of each primitive
  const std::size_t step = std::max<std::size_t>(1, surface.point_mm.size() / (4 * kSample));
  std::size_t looked_at = 0;
  for (std::size_t i = 0; i < surface.point_mm.size(); i += step, ++looked_at) {
    const Vec3 at_mm = surface.point_mm[i].cast<double>();
    const Vec3 normal = surface.normal[i].cast<double>();
    const int owner = primitive_of(primitives, at_mm, normal);
    if (owner >= 0) points[static_cast<std::size_t>(owner)] += 1.0;
    if (owner < 0 || primitives[static_cast<std::size_t>(owner)].kind != PrimitiveKind::kPlane) {
      left.push_back({at_mm, normal, owner});
    }
  }
  const auto least = static_cast<std::size_t>(kLeastShare * static_cast<double>(looked_at)) + 12;
  std::vector<TaughtCone> cones;
  std::vector<bool> misfit(primitives.size(), false);
  Random random(seed, 4);
  for (int attempt = 0; attempt < kAttempts && left.size() >= least; ++attempt) {
    auto cone = find_one(left, least, random);
    if (!cone) break;
    const std::vector<Point> inliers = lying_on(*cone, left);
    std::erase_if(left, [&](const Point& p) { return on_cone(*cone, p.at_mm, p.normal); });
    std::vector<double> shared(primitives.size(), 0.0);
    for (const Point& p : inliers) {
      if (p.owner >= 0) shared[static_cast<std::size_t>(p.owner)] += 1.0;
    }
    const auto count = static_cast<double>(inliers.size());
    bool band = false;
    for (std::size_t p = 0; p < shared.size(); ++p) band = band || (shared[p] > 0.3 * count && points[p] > 0.7 * count);
    if (band || !goes_round(*cone, inliers)) continue;
    for (std::size_t p = 0; p < shared.size(); ++p) misfit[p] = misfit[p] || shared[p] > 0.6 * points[p];
    measure_extent(*cone, inliers);
    cone->surface_share = count / static_cast<double>(looked_at);
    cones.push_back(*cone);
  }
  std::size_t p = 0;
  std::erase_if(primitives,
                [&](const Primitive& primitive) { return misfit[p++] && primitive.kind != PrimitiveKind::kPlane; });
  std::stable_sort(cones.begin(), cones.end(),
                   [](const auto& a, const auto& b) { return a.surface_share > b.surface_share; });
  return cones;
}

}  // namespace beltpick::teach
