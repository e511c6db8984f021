#include "pipeline/light_fit.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace beltpick::pipeline {
namespace {

constexpr std::size_t kSamples = 8192;
constexpr int kStep_px = 4;
// A gap is no speckle, nor the rim of one: so many pixels round it are gaps, too.
constexpr int kGapReach_px = 3;
constexpr std::size_t kLeastDark = 100;
// The light must explain so much of the gaps, and deny so little of what was measured.
constexpr double kLeastExplained = 0.5;
constexpr double kMostDenied = 0.03;
constexpr float kMargin_mm = 3.0F;
// Bounds of the angle at which light and camera stand apart, and the search from coarse to fine.
constexpr double kLeastAngle_rad = 0.1, kMostAngle_rad = 1.0;
constexpr int kAzimuths = 16, kAngles = 4, kRefinements = 4;

// Whether the pixel and all round it lack a measurement.
bool in_gap(const RangeImage& range, int row, int col) {
  for (int r = row - kGapReach_px; r <= row + kGapReach_px; r += kGapReach_px) {
    for (int c = col - kGapReach_px; c <= col + kGapReach_px; c += kGapReach_px) {
      if (!range.point_mm.contains(r, c) || range.valid(r, c)) return false;
    }
  }
  return true;
}

}  // namespace

LightFinder::LightFinder(Arena& arena, const Limits& limits)
    : shadows_(arena, limits),
      dark_(arena.take<Vec3f>("locate: light", kSamples)),
      measured_(arena.take<Vec3f>("locate: light", kSamples)) {}

std::optional<Vec3> LightFinder::find(const RangeImage& range, const Lens& lens, const std::optional<Plane>& belt) {
  if (!belt) return std::nullopt;
  gather(range, lens, *belt);
  if (dark_count_ < kLeastDark || measured_count_ < kLeastDark) return std::nullopt;
  Place best{};
  const auto consider = [&](Place place) {
    place.angle_rad = std::clamp(place.angle_rad, kLeastAngle_rad, kMostAngle_rad);
    rate(range, belt, place);
    if (place.merit > best.merit) best = place;
  };
  double azimuth_step = 2.0 * kPi / kAzimuths;
  double angle_step = (kMostAngle_rad - kLeastAngle_rad) / kAngles;
  for (int i = 0; i < kAzimuths; ++i) {
    for (int j = 0; j < kAngles; ++j) consider({i * azimuth_step, kLeastAngle_rad + (j + 0.5) * angle_step});
  }
  for (int i = 0; i < kRefinements; ++i) {
    azimuth_step *= 0.5;
    angle_step *= 0.5;
    const Place from = best;
    for (const double a : {-1.0, 0.0, 1.0}) {
      for (const double b : {-1.0, 0.0, 1.0}) {
        if (a != 0.0 || b != 0.0) consider({from.azimuth_rad + a * azimuth_step, from.angle_rad + b * angle_step});
      }
    }
  }
  if (best.merit < kLeastExplained) return std::nullopt;
  return position_mm(best);
}

// Gaps are mostly shadows on the belt: each is taken to lie there.
void LightFinder::gather(const RangeImage& range, const Lens& lens, const Plane& belt) {
  dark_count_ = measured_count_ = 0;
  belt_normal_ = belt.normal.cast<float>();
  Vec3 sum = Vec3::Zero();
  // Spread over the image, however many there are.
  int step = kStep_px;
  while (static_cast<std::size_t>(range.point_mm.rows / step) * static_cast<std::size_t>(range.point_mm.cols / step) >
         2 * kSamples)
    ++step;
  for (int row = step; row < range.point_mm.rows; row += step) {
    for (int col = step; col < range.point_mm.cols; col += step) {
      if (range.valid(row, col)) {
        if (measured_count_ < kSamples) measured_[measured_count_++] = range.point_mm(row, col);
        sum += range.point_mm(row, col).cast<double>();
      } else if (dark_count_ < kSamples && in_gap(range, row, col)) {
        const Vec3 ray((col - lens.cx_px) / lens.fx_px, (row - lens.cy_px) / lens.fy_px, 1.0);
        const double along = belt.offset_mm / belt.normal.dot(ray);
        if (along > 0.0) dark_[dark_count_++] = (along * ray).cast<float>();
      }
    }
  }
  if (measured_count_ > 0) middle_mm_ = sum / sum.norm() * std::abs(belt.offset_mm / belt.normal.dot(sum / sum.norm()));
}

Vec3 LightFinder::position_mm(const Place& place) const {
  const Vec3 sight = middle_mm_.normalized();
  const Vec3 u = (Vec3::UnitX() - sight * sight.x()).normalized();
  const Vec3 v = sight.cross(u);
  const Vec3 aside = std::cos(place.azimuth_rad) * u + std::sin(place.azimuth_rad) * v;
  const Vec3 back = -std::cos(place.angle_rad) * sight + std::sin(place.angle_rad) * aside;
  return middle_mm_ + middle_mm_.norm() * back;
}

void LightFinder::rate(const RangeImage& range, const std::optional<Plane>& belt, Place& place) {
  shadows_.cast(range, position_mm(place), belt);
  const auto hidden_share = [&](std::span<const Vec3f> points) {
    const auto hidden = std::count_if(points.begin(), points.end(),
                                      [&](const Vec3f& at) { return shadows_.hides(at, belt_normal_, kMargin_mm); });
    return static_cast<double>(hidden) / static_cast<double>(points.size());
  };
  const double denied = hidden_share(measured_.first(measured_count_));
  place.merit = denied > kMostDenied ? -1.0 : hidden_share(dark_.first(dark_count_)) - 5.0 * denied;
}

}  // namespace beltpick::pipeline
