#include "scans/agreement.hpp"

#include <algorithm>
#include <cmath>

namespace beltpick::scans {
namespace {

constexpr float kFacing = 0.7F;
constexpr double kContradictionWeight = 3.0;

}  // namespace

Agreement look_up(const ScanView& scan, const ScanView& other, const CrossPose& T_other_scan,
                  const AgreementLimits& limits) {
  const Eigen::Matrix3f rotation = T_other_scan.rotation.cast<float>();
  const Vec3f translation = T_other_scan.translation_mm.cast<float>();
  const auto surface = static_cast<float>(limits.surface_mm);
  const auto aside = static_cast<float>(std::max(2.0 * other.spacing_mm, limits.surface_mm));
  const std::size_t count = std::min(limits.points, scan.point.size());
  int agreeing = 0;
  int contradicting = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f at = rotation * scan.point[i].point_mm + translation;
    const OrientedPoint& nearest = other.nearest(at);
    const Vec3f apart = at - nearest.point_mm;
    if (std::abs(nearest.normal.dot(apart)) < surface && apart.squaredNorm() < aside * aside + surface * surface) {
      // Near the surface nothing contradicts; the far side of a thin sheet does not agree either.
      agreeing += nearest.normal.dot(rotation * scan.point[i].normal) > kFacing ? 1 : 0;
      continue;
    }
    const Vec3 place = at.cast<double>();
    const bool sunk = other.belt && other.belt->height_mm(place) < -limits.space_mm;
    contradicting += sunk || other.seen.in_front_mm(place) > limits.space_mm ? 1 : 0;
  }
  return {static_cast<double>(agreeing) / static_cast<double>(count),
          static_cast<double>(contradicting) / static_cast<double>(count)};
}

Agreement mutual(const ScanView& a, const ScanView& b, const CrossPose& T_a_b, const AgreementLimits& limits) {
  const Agreement one = look_up(b, a, T_a_b, limits);
  const Agreement two = look_up(a, b, T_a_b.inverse(), limits);
  // The lesser part of one may stand in the space of the other, not of both.
  return {0.5 * (one.agreeing + two.agreeing), std::max(one.contradicting, two.contradicting)};
}

double merit(const Agreement& agreement) { return agreement.agreeing - kContradictionWeight * agreement.contradicting; }

}  // namespace beltpick::scans
