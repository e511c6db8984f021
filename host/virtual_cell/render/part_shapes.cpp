// Solids from distance primitives, joined with the fillets that castings have.
#include "virtual_cell/render/part_shapes.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::virtual_cell {
namespace {

// Union with a fillet of about `radius_mm`; exact away from where the two solids meet.
double join(double a, double b, double radius_mm) {
  const double h = std::max(radius_mm - std::abs(a - b), 0.0) / radius_mm;
  return std::min(a, b) - h * h * radius_mm * 0.25;
}

// `a` without `b`, the edge broken by about `radius_mm`.
double cut(double a, double b, double radius_mm) { return -join(-a, b, radius_mm); }

// A box with its edges rounded; `half_mm` includes the rounding.
double box(const Vec3& p, const Vec3& half_mm, double round_mm) {
  const Vec3 q = p.cwiseAbs() - (half_mm - Vec3::Constant(round_mm));
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - round_mm;
}

// A cylinder with its rims rounded; `along` the distance from its middle on the axis, `across` the distance from the
// axis.
double cylinder(double across, double along, double radius_mm, double half_length_mm, double round_mm) {
  const double dx = across - (radius_mm - round_mm);
  const double dy = std::abs(along) - (half_length_mm - round_mm);
  return std::min(std::max(dx, dy), 0.0) + std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) - round_mm;
}

double cylinder_x(const Vec3& p, double r, double half, double round) {
  return cylinder(std::hypot(p.y(), p.z()), p.x(), r, half, round);
}
double cylinder_y(const Vec3& p, double r, double half, double round) {
  return cylinder(std::hypot(p.x(), p.z()), p.y(), r, half, round);
}
double cylinder_z(const Vec3& p, double r, double half, double round) {
  return cylinder(std::hypot(p.x(), p.y()), p.z(), r, half, round);
}

// A bar from `a` to `b` whose elliptic section shrinks from radius ra to rb, flattened in z by `flat`.
double tapered_bar(Vec3 p, Vec3 a, Vec3 b, double ra, double rb, double flat) {
  p.z() /= flat;
  a.z() /= flat;
  b.z() /= flat;
  const Vec3 along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return ((p - a - t * along).norm() - (ra + t * (rb - ra))) * flat;
}

}  // namespace

double knuckle_distance(const Vec3& p) {
  const Vec3 boss_at(-40.0, 0.0, 0.0);
  const Vec3 eye_at(88.0, 12.0, -6.0);
  const double boss = cylinder_y(p - boss_at, kKnuckleBossRadiusMm, 38.0, 1.5);
  const double eye = cylinder_z(p - eye_at, 20.0, 14.0, 1.5);
  const double arm = tapered_bar(p, {-30.0, -4.0, -3.0}, {80.0, 11.0, -6.0}, 25.0, 16.0, 0.5);
  const double ear = box(p - Vec3(-6.0, 50.0, 6.0), {15.0, 15.0, 7.0}, 3.0);
  const double ear_neck = tapered_bar(p, {-14.0, 12.0, 2.0}, {-6.0, 44.0, 6.0}, 15.0, 12.0, 0.6);
  const double rib = box(p - Vec3(22.0, 3.0, 6.0), {48.0, 4.0, 11.0}, 2.5);
  const double foot = cylinder_z(p - Vec3(34.0, -9.0, -19.0), 9.0, 10.0, 2.0);
  double solid = join(boss, arm, 7.0);
  solid = join(solid, eye, 6.0);
  solid = join(solid, join(ear, ear_neck, 6.0), 6.0);
  solid = join(solid, rib, 5.0);
  solid = join(solid, foot, 5.0);
  const double bore = cylinder_y(p - boss_at - Vec3(0.0, 18.0, 0.0), kKnuckleBoreRadiusMm, 30.0, 0.5);
  solid = cut(solid, bore, 1.5);
  solid = cut(solid, cylinder_z(p - eye_at, 9.0, 40.0, 0.5), 1.5);
  return cut(solid, cylinder_z(p - Vec3(-6.0, 51.0, 6.0), 5.5, 30.0, 0.5), 1.0);
}

Eigen::AlignedBox3d knuckle_box() { return {Vec3(-67.0, -39.0, -30.0), Vec3(109.0, 66.0, 28.0)}; }

double elbow_distance(const Vec3& p) {
  constexpr double kBend = 45.0;
  // The bend lies in the quadrant x, y > 0 about the origin; the straight ends run to the flanges along -y and -x.
  const double ring = std::hypot(std::hypot(p.x(), p.y()) - kBend, p.z());
  const Vec3 to_first(p.x() - kBend, p.y(), p.z());
  const Vec3 to_second(p.x(), p.y() - kBend, p.z());
  const bool in_bend = p.x() >= 0.0 && p.y() >= 0.0;
  const auto pipe = [&](double radius) {
    const double first = cylinder_y(to_first + Vec3(0.0, 15.0, 0.0), radius, 15.0, 0.2);
    const double second = cylinder_x(to_second + Vec3(15.0, 0.0, 0.0), radius, 15.0, 0.2);
    return std::min({in_bend ? ring - radius : 1e3, first, second});
  };
  const Vec3 flange_first = to_first + Vec3(0.0, 30.0, 0.0);
  const Vec3 flange_second = to_second + Vec3(30.0, 0.0, 0.0);
  double solid = join(pipe(21.0), cylinder_y(flange_first, 37.0, 6.0, 1.2), 5.0);
  solid = join(solid, cylinder_x(flange_second, 37.0, 6.0, 1.2), 5.0);
  const auto bore = [&] {
    const double first = cylinder_y(flange_first - Vec3(0.0, 13.0, 0.0), 14.0, 24.0, 0.2);
    const double second = cylinder_x(flange_second - Vec3(13.0, 0.0, 0.0), 14.0, 24.0, 0.2);
    return std::min({in_bend ? ring - 14.0 : 1e3, first, second});
  };
  solid = cut(solid, bore(), 1.0);
  for (const double u : {-19.5, 19.5}) {
    for (const double v : {-19.5, 19.5}) {
      solid = cut(solid, cylinder_y(flange_first - Vec3(u, 0.0, v), 4.0, 9.0, 0.2), 0.8);
      solid = cut(solid, cylinder_x(flange_second - Vec3(0.0, u, v), 4.0, 9.0, 0.2), 0.8);
    }
  }
  return solid;
}

Eigen::AlignedBox3d elbow_box() { return {Vec3(-38.0, -38.0, -38.0), Vec3(84.0, 84.0, 38.0)}; }

double bracket_distance(const Vec3& p) {
  const double base = box(p - Vec3(0.0, 0.0, 5.0), {55.0, 35.0, 5.0}, 1.5);
  const double wall = box(p - Vec3(-50.0, 0.0, 30.0), {5.0, 35.0, 30.0}, 1.5);
  const double post = cylinder_z(p - Vec3(22.0, -8.0, 22.0), 14.0, 22.0, 1.5);
  const double slope = (p.x() + 45.0) + (p.z() - 10.0) - 34.0;
  const double gusset = std::max(box(p - Vec3(-30.0, 12.0, 25.0), {20.0, 4.0, 20.0}, 1.0), slope * std::sqrt(0.5));
  double solid = join(base, wall, 4.0);
  solid = join(solid, post, 4.0);
  solid = join(solid, gusset, 3.0);
  solid = cut(solid, cylinder_z(p - Vec3(22.0, -8.0, 30.0), 7.0, 20.0, 0.3), 1.0);
  solid = cut(solid, cylinder_z(p - Vec3(40.0, 20.0, 5.0), 6.0, 20.0, 0.3), 1.0);
  return cut(solid, cylinder_x(p - Vec3(-50.0, -12.0, 40.0), 8.0, 20.0, 0.3), 1.0);
}

Eigen::AlignedBox3d bracket_box() { return {Vec3(-56.0, -36.0, -1.0), Vec3(56.0, 36.0, 61.0)}; }

double vblock_distance(const Vec3& p) {
  const double block = box(p - Vec3(0.0, 0.0, 22.0), {60.0, 35.0, 22.0}, 1.5);
  // The groove's walls rise at 45 degrees from a line 10 mm above the base.
  const double groove = (std::abs(p.x() + 29.0) - (p.z() - 10.0)) * std::sqrt(0.5);
  const double pocket = box(p - Vec3(34.0, 3.0, 34.0), {18.0, 24.0, 22.0}, 3.0);
  return cut(cut(block, groove, 1.0), pocket, 1.0);
}

Eigen::AlignedBox3d vblock_box() { return {Vec3(-61.0, -36.0, -1.0), Vec3(61.0, 36.0, 45.0)}; }

double balljoint_distance(const Vec3& p) {
  const double housing = p.norm() - 21.0;
  const double cap = cylinder_z(p + Vec3(0.0, 0.0, 16.0), 17.0, 6.0, 1.5);
  const double boot = tapered_bar(p, {0.0, 0.0, 14.0}, {0.0, 0.0, 28.0}, 15.0, 9.5, 1.0);
  const double stud = cylinder_z(p - Vec3(0.0, 0.0, 42.0), 7.0, 21.0, 1.0);
  const double shank = cylinder_x(p - Vec3(52.0, 0.0, 0.0), 10.0, 38.0, 1.5);
  const double collar = cylinder_x(p - Vec3(32.0, 0.0, 0.0), 14.0, 7.0, 1.0);
  double solid = join(join(housing, cap, 3.0), boot, 3.0);
  solid = join(solid, stud, 2.0);
  solid = join(solid, join(shank, collar, 2.0), 5.0);
  return cut(solid, cylinder_x(p - Vec3(85.0, 0.0, 0.0), 6.0, 25.0, 0.3), 1.0);
}

Eigen::AlignedBox3d balljoint_box() { return {Vec3(-22.0, -22.0, -23.0), Vec3(91.0, 22.0, 64.0)}; }

double sheet_distance(const Vec3& p) {
  constexpr double kHalf = 1.25;
  const double base = box(p - Vec3(0.0, 0.0, kHalf), {55.0, 35.0, kHalf}, 0.4);
  const double flange = box(p - Vec3(-55.0 + kHalf, 0.0, 12.0), {kHalf, 35.0, 12.0}, 0.4);
  const double tab = box(p - Vec3(15.0, 35.0 - kHalf, 8.0), {22.0, kHalf, 8.0}, 0.4);
  double solid = join(join(base, flange, 2.0), tab, 2.0);
  const double corner = (p.x() - p.y() - 68.0) * std::sqrt(0.5);  // cut off at 45 degrees
  solid = std::max(solid, corner);
  solid = std::max(solid, -cylinder_z(p - Vec3(-27.0, 12.0, 0.0), 7.0, 20.0, 0.2));
  solid = std::max(solid, -cylinder_z(p - Vec3(32.0, 10.0, 0.0), 4.0, 20.0, 0.2));
  return std::max(solid, -box(p - Vec3(0.0, -14.0, 0.0), {18.0, 4.0, 10.0}, 3.9));
}

Eigen::AlignedBox3d sheet_box() { return {Vec3(-56.0, -36.0, -1.0), Vec3(56.0, 36.0, 25.0)}; }

}  // namespace beltpick::virtual_cell
