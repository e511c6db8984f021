#include "support/scenes/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/random.hpp"
#include "base/units.hpp"

namespace beltpick::test {
namespace {

Distance box(const Vec3& centre, const Vec3& size) {
  return [=](const Vec3& p) {
    const Vec3 q = (p - centre).cwiseAbs() - 0.5 * size;
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
  };
}

// Along the given axis (0, 1, 2).
Distance cylinder(const Vec3& centre, int axis, double radius, double length) {
  return [=](const Vec3& p) {
    Vec3 d = p - centre;
    const double along = std::abs(d[axis]) - 0.5 * length;
    d[axis] = 0.0;
    const double across = d.norm() - radius;
    const double outside = std::hypot(std::max(along, 0.0), std::max(across, 0.0));
    return outside + std::min(std::max(along, across), 0.0);
  };
}

Distance join(Distance a, Distance b) {
  return [=](const Vec3& p) { return std::min(a(p), b(p)); };
}
Distance cut(Distance a, Distance b) {
  return [=](const Vec3& p) { return std::max(a(p), -b(p)); };
}

Primitive cylinder_primitive(const Vec3& point, const Vec3& axis, double radius, double length, bool concave) {
  Primitive p;
  p.kind = PrimitiveKind::kCylinder;
  p.point_mm = point;
  p.direction = axis;
  p.radius_mm = radius;
  p.extent_mm = length;
  p.concave = concave;
  return p;
}

Pose<frame::Part, frame::Part> turn(const Vec3& axis, double angle) {
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), Vec3::Zero()};
}

}  // namespace

Shape bracket() {
  Shape s;
  s.name = "bracket";
  s.distance =
      join(join(box({0, 0, 5}, {100, 60, 10}), box({-45, 0, 30}, {10, 60, 50})), cylinder({30, 15, 20}, 2, 11, 20));
  s.distance = cut(s.distance, cylinder({25, -18, 5}, 2, 7, 30));
  s.box_min_mm = {-50, -30, 0};
  s.box_max_mm = {50, 30, 55};
  s.primitives = {cylinder_primitive({30, 15, 20}, Vec3::UnitZ(), 11, 20, false)};
  return s;
}

Shape mirrored(Shape of) {
  const auto original = of.distance;
  of.name = "mirrored " + of.name;
  of.distance = [=](const Vec3& p) { return original({-p.x(), p.y(), p.z()}); };
  const Vec3 low = of.box_min_mm;
  of.box_min_mm.x() = -of.box_max_mm.x();
  of.box_max_mm.x() = -low.x();
  of.primitives.clear();
  return of;
}

Shape knuckle() {
  Shape s;
  s.name = "knuckle";
  const Distance hub = cylinder({0, 0, 0}, 1, 24, 70);
  const Distance arm = box({50, 10, -6}, {80, 26, 20});
  const Distance lug = cylinder({95, 10, 2}, 2, 18, 34);
  const Distance rib = box({-30, -12, 5}, {40, 12, 30});
  s.distance =
      cut(cut(join(join(hub, arm), join(lug, rib)), cylinder({0, 0, 0}, 1, 15, 90)), cylinder({95, 10, 2}, 2, 8, 60));
  s.box_min_mm = {-50, -35, -24};
  s.box_max_mm = {113, 35, 24};
  s.primitives = {cylinder_primitive({0, 0, 0}, Vec3::UnitY(), 24, 70, false),
                  cylinder_primitive({95, 10, 2}, Vec3::UnitZ(), 18, 34, false)};
  return s;
}

Shape block() {
  Shape s;
  s.name = "block";
  s.distance = box(Vec3::Zero(), {80, 50, 30});
  s.box_min_mm = {-40, -25, -15};
  s.box_max_mm = {40, 25, 15};
  s.symmetry.name = "D2";
  s.symmetry.elements = {turn(Vec3::UnitX(), kPi), turn(Vec3::UnitY(), kPi), turn(Vec3::UnitZ(), kPi)};
  return s;
}

Shape pin() {
  Shape s;
  s.name = "pin";
  s.distance = cylinder(Vec3::Zero(), 2, 12, 90);
  s.box_min_mm = {-12, -12, -45};
  s.box_max_mm = {12, 12, 45};
  s.primitives = {cylinder_primitive(Vec3::Zero(), Vec3::UnitZ(), 12, 90, false)};
  s.symmetry.name = "revolution";
  s.symmetry.revolution = true;
  s.symmetry.elements = {turn(Vec3::UnitX(), kPi)};
  return s;
}

Shape flange() {
  Shape s;
  s.name = "flange";
  s.distance = join(cylinder({0, 0, 6}, 2, 50, 12), cylinder({0, 0, 22}, 2, 22, 44));
  s.distance = cut(s.distance, cylinder({0, 0, 20}, 2, 14, 100));
  for (int i = 0; i < 4; ++i) {
    const double angle = kPi / 2 * i;
    s.distance = cut(s.distance, cylinder({37 * std::cos(angle), 37 * std::sin(angle), 6}, 2, 6, 40));
  }
  s.box_min_mm = {-50, -50, 0};
  s.box_max_mm = {50, 50, 44};
  s.primitives = {cylinder_primitive({0, 0, 28}, Vec3::UnitZ(), 22, 32, false)};
  s.symmetry.name = "C4";
  s.symmetry.elements = {turn(Vec3::UnitZ(), kPi / 2), turn(Vec3::UnitZ(), kPi), turn(Vec3::UnitZ(), 3 * kPi / 2)};
  return s;
}

Shape plate() {
  Shape s;
  s.name = "plate";
  s.distance = box(Vec3::Zero(), {200, 140, 12});
  s.box_min_mm = {-100, -70, -6};
  s.box_max_mm = {100, 70, 6};
  return s;
}

Shape sheet() {
  Shape s;
  s.name = "sheet";
  s.distance = join(join(box({0, 0, 0}, {90, 50, 3}), box({43.5, 0, 12}, {3, 50, 27})), box({-20, 40, 0}, {30, 40, 3}));
  s.distance = cut(s.distance, cylinder({10, -8, 0}, 2, 9, 20));
  s.box_min_mm = {-45, -25, -1.5};
  s.box_max_mm = {45, 60, 25.5};
  return s;
}

Vec3 gradient(const Distance& distance, const Vec3& at) {
  constexpr double h = 1e-4;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis)
    g[axis] = distance(at + h * Vec3::Unit(axis)) - distance(at - h * Vec3::Unit(axis));
  return g.normalized();
}

PartTemplate template_of(const Shape& shape, std::size_t points) {
  PartTemplate part;
  part.name = shape.name;
  part.box_min_mm = shape.box_min_mm;
  part.box_max_mm = shape.box_max_mm;
  part.primitives = shape.primitives;
  part.symmetry = shape.symmetry;
  // Darts at the surface, most of them refused: a cell of a hashed lattice holds one point a normal's direction.
  Random random(7);
  std::vector<Vec3> at, normal;
  const Vec3 extent = shape.box_max_mm - shape.box_min_mm;
  for (int dart = 0; dart < 2'000'000 && at.size() < 12 * points; ++dart) {
    Vec3 p = shape.box_min_mm + extent.cwiseProduct(Vec3(random.uniform(), random.uniform(), random.uniform()));
    if (std::abs(shape.distance(p)) > 2.0) continue;
    for (int i = 0; i < 3; ++i) p -= shape.distance(p) * gradient(shape.distance, p);
    if (std::abs(shape.distance(p)) > 1e-6) continue;
    at.push_back(p);
    normal.push_back(gradient(shape.distance, p));
  }
  // Sample density to spacing: thin until about `points` are left.
  double spacing = 0.5;
  std::vector<std::size_t> kept;
  for (;; spacing *= 1.1) {
    std::unordered_multimap<long, std::size_t> cells;
    const auto cell_of = [&](const Vec3& p, int dx, int dy, int dz) {
      return (std::lround(std::floor(p.x() / spacing)) + dx) * 73856093L ^
             (std::lround(std::floor(p.y() / spacing)) + dy) * 19349663L ^
             (std::lround(std::floor(p.z() / spacing)) + dz) * 83492791L;
    };
    kept.clear();
    for (std::size_t i = 0; i < at.size(); ++i) {
      bool free = true;
      for (int n = 0; n < 27 && free; ++n) {
        const auto [first, last] = cells.equal_range(cell_of(at[i], n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
        for (auto it = first; it != last && free; ++it) {
          free = (at[it->second] - at[i]).norm() > spacing || normal[it->second].dot(normal[i]) < 0.5;
        }
      }
      if (!free) continue;
      kept.push_back(i);
      cells.emplace(cell_of(at[i], 0, 0, 0), i);
    }
    if (kept.size() <= points) break;
  }
  for (const std::size_t i : kept) {
    part.point_mm.push_back(at[i].cast<float>());
    part.normal.push_back(normal[i].cast<float>());
  }
  part.spacing_mm = 1.2 * spacing;
  return part;
}

}  // namespace beltpick::test
