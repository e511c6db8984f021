#include "teach/resting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/units.hpp"

namespace beltpick::teach {

namespace {

// The part is let fall from so many orientations.
constexpr int kFalls = 1500;
// In which its outermost points are looked for.
constexpr int kDirections = 2000;
// Positions that differ less are one; a part that rests on points of a curved face does so on many.
constexpr double kSame_rad = rad_from_deg(4.0);
constexpr double kLeastLikelihood = 0.01;
constexpr double kBalanced = 0.003;      // let go exactly over an edge, it stays there
constexpr std::size_t kAlwaysKept = 12;  // what rolls rests nearly anywhere
// What a support must leave between the centre of gravity's foot and its edge to hold, of the part's size.
constexpr double kHold = 1e-3;
constexpr int kMostTips = 60;

// Points far enough out to touch a plane: those farthest along one of many directions.
std::vector<Vec3> outermost(const std::vector<Vec3f>& surface_mm, int directions) {
  std::vector<std::size_t> chosen;
  for (int i = 0; i < directions; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / directions;
    const double angle = i * kPi * (3.0 - std::sqrt(5.0));
    const double across = std::sqrt(1.0 - z * z);
    const Vec3f direction = Vec3(across * std::cos(angle), across * std::sin(angle), z).cast<float>();
    std::size_t farthest = 0;
    float most = surface_mm.front().dot(direction);
    for (std::size_t p = 1; p < surface_mm.size(); ++p) {
      const float out = surface_mm[p].dot(direction);
      if (out <= most) continue;
      most = out;
      farthest = p;
    }
    chosen.push_back(farthest);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  std::vector<Vec3> points;
  for (const std::size_t p : chosen) points.push_back(surface_mm[p].cast<double>());
  return points;
}

using Place = Eigen::Vector2d;  // in the belt's plane, the centre of gravity's foot at its origin

double turning(const Place& a, const Place& b, const Place& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Counter-clockwise (Andrew's monotone chain).
std::vector<Place> convex_hull(std::vector<Place> points) {
  std::sort(points.begin(), points.end(),
            [](const Place& a, const Place& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  if (points.size() < 3) return points;
  std::vector<Place> hull;
  const auto add = [&hull](const Place& p, std::size_t keep) {
    while (hull.size() >= keep + 2 && turning(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Place& p : points) add(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  hull.pop_back();
  return hull;
}

// A part that stands on some of its outermost points, and tips about them.
class Fall {
 public:
  Fall(const std::vector<Vec3>& points, const Vec3& centre) : points_(points), centre_(centre) {
    for (const Vec3& point : points) size_ = std::max(size_, (point - centre).norm());
  }

  // Where `down` ends when the part, let go so, has come to rest.
  [[nodiscard]] Vec3 settle(Vec3 down) const {
    std::vector<std::size_t> contacts{lowest(down)};
    for (int tip = 0; tip < kMostTips; ++tip) {
      const Vec3 foot = nearest_of_support(contacts, down);
      Vec3 lever = centre_ - foot;
      lever -= lever.dot(down) * down;
      if (lever.norm() < kHold * size_) return down;
      // It tips over the foot to the side on which its centre of gravity is, until another point meets the belt.
      lever.normalize();
      double least = std::numeric_limits<double>::max();
      std::vector<std::size_t> next;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vec3 arm = points_[i] - foot;
        const double below = arm.dot(down);
        const double ahead = arm.dot(lever);
        if (ahead < 5e-3 * size_) continue;
        const double angle = std::atan2(-below, ahead);
        if (angle < least) {
          least = angle;
          next = {i};
        }
      }
      if (next.empty()) return down;
      least = std::max(0.0, least);
      down = (std::cos(least) * down + std::sin(least) * lever).normalized();
      contacts = touching(down);
    }
    return down;
  }

  [[nodiscard]] double height_mm(const Vec3& down) const { return (points_[lowest(down)] - centre_).dot(down); }

 private:
  [[nodiscard]] std::size_t lowest(const Vec3& down) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      if (points_[i].dot(down) > points_[best].dot(down)) best = i;
    }
    return best;
  }

  [[nodiscard]] std::vector<std::size_t> touching(const Vec3& down) const {
    const double level = points_[lowest(down)].dot(down);
    std::vector<std::size_t> contacts;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i].dot(down) > level - 2e-3 * size_) contacts.push_back(i);
    }
    return contacts;
  }

  // The place of the support's hull that is nearest to the foot of the centre of gravity; the foot itself inside.
  [[nodiscard]] Vec3 nearest_of_support(const std::vector<std::size_t>& contacts, const Vec3& down) const {
    const Vec3 u = down.unitOrthogonal();
    const Vec3 v = down.cross(u);
    std::vector<Place> support;
    for (const std::size_t i : contacts) support.push_back({u.dot(points_[i] - centre_), v.dot(points_[i] - centre_)});
    const std::vector<Place> hull = convex_hull(support);
    Place nearest = hull.front();
    bool inside = hull.size() > 2;
    for (std::size_t k = 0; k < hull.size(); ++k) {
      const Place& from = hull[k];
      const Place side = hull[(k + 1) % hull.size()] - from;
      inside = inside && turning(from, from + side, Place::Zero()) >= 0;
      const double along = side.squaredNorm() > 0 ? std::clamp(-from.dot(side) / side.squaredNorm(), 0.0, 1.0) : 0.0;
      const Place foot = from + along * side;
      if (foot.norm() < nearest.norm()) nearest = foot;
    }
    if (inside) nearest.setZero();
    return centre_ + nearest.x() * u + nearest.y() * v + (points_[contacts.front()] - centre_).dot(down) * down;
  }

  const std::vector<Vec3>& points_;
  Vec3 centre_;
  double size_ = 0.0;
};

// Whether two positions look alike, the part's symmetry allowed for.
bool same_position(const Vec3& a, const Vec3& b, const Symmetry& symmetry) {
  const auto near = [](double cosine) { return cosine > std::cos(kSame_rad); };
  if (symmetry.name == "sphere" || near(a.dot(b))) return true;
  const auto along = [&](const Vec3& v) { return std::acos(std::clamp(v.dot(symmetry.axis_direction), -1.0, 1.0)); };
  const auto alike = [&](const Vec3& v) {
    return near(a.dot(v)) || (symmetry.revolution && std::abs(along(a) - along(v)) < kSame_rad);
  };
  return alike(b) || std::any_of(symmetry.elements.begin(), symmetry.elements.end(),
                                 [&](const auto& element) { return alike(element.rotation * b); });
}

}  // namespace

Vec3 centre_of_gravity_mm(const Mesh& mesh, const Surface& surface) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3f& point : surface.point_mm) mean += point.cast<double>();
  mean /= static_cast<double>(surface.point_mm.size());
  Vec3 moment = Vec3::Zero();
  double volume = 0.0;
  double size = 0.0;
  for (const auto& face : mesh.face) {
    const Vec3 a = mesh.vertex_mm[face[0]].cast<double>() - mean;
    const Vec3 b = mesh.vertex_mm[face[1]].cast<double>() - mean;
    const Vec3 c = mesh.vertex_mm[face[2]].cast<double>() - mean;
    const double six = a.dot(b.cross(c));
    volume += six / 6.0;
    moment += six / 24.0 * (a + b + c);
    size = std::max(size, a.norm());
  }
  // A surface that encloses next to nothing has no volume to speak of.
  if (!(volume > 1e-4 * size * size * size)) return mean;
  const Vec3 offset = moment / volume;
  return offset.norm() < size ? Vec3(mean + offset) : mean;
}

std::vector<RestingPosition> resting_positions(const std::vector<Vec3f>& surface_mm, const Vec3& centre_of_gravity_mm,
                                               const Symmetry& symmetry) {
  const std::vector<Vec3> points = outermost(surface_mm, kDirections);
  const Fall fall(points, centre_of_gravity_mm);
  std::vector<RestingPosition> found;
  for (int i = 0; i < kFalls; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kFalls;
    const double angle = i * kPi * (3.0 - std::sqrt(5.0));
    const double across = std::sqrt(1.0 - z * z);
    const Vec3 down = fall.settle({across * std::cos(angle), across * std::sin(angle), z});
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&](const RestingPosition& r) { return same_position(r.down, down, symmetry); });
    if (same == found.end()) {
      found.push_back({down, fall.height_mm(down), 1.0 / kFalls});
    } else {
      same->likelihood += 1.0 / kFalls;
    }
  }
  std::erase_if(found, [](const RestingPosition& r) { return r.likelihood < kBalanced; });
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.likelihood > b.likelihood; });
  while (found.size() > kAlwaysKept && found.back().likelihood < kLeastLikelihood) found.pop_back();
  double sum = 0.0;
  for (const RestingPosition& r : found) sum += r.likelihood;
  for (RestingPosition& r : found) r.likelihood /= sum;
  return found;
}

}  // namespace beltpick::teach
