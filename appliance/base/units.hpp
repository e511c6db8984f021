// Units: millimetres, radians and microseconds inside; degrees only at a person's eyes.
#pragma once

#include <numbers>

namespace beltpick {

inline constexpr double kPi = std::numbers::pi;

constexpr double rad_from_deg(double angle_deg) { return angle_deg * kPi / 180.0; }
constexpr double deg_from_rad(double angle_rad) { return angle_rad * 180.0 / kPi; }

}  // namespace beltpick
