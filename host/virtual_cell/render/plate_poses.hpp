// How a person holds the calibration plate before the camera, capture after capture: carefully, or not.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "virtual_cell/render/plate.hpp"
#include "virtual_cell/render/rig.hpp"

namespace beltpick::virtual_cell {

enum class PlatePoses : std::uint8_t {
  kGood,     // tilted to all sides by up to 33 degrees, over the view and over 0..100 mm, turned in the plane
  kFlat,     // never tilted
  kNear,     // all nearly the same
  kPartial,  // as kGood, but two of three captures cut off by the image's border
  kOnBelt    // lying on the belt
};
inline constexpr std::array<std::string_view, 5> kPlatePosesNames{"good", "flat", "near", "partial", "on-belt"};

// `count` poses of the plate (frame::Part is the plate's frame). The plate never reaches below the belt; but for
// kPartial the whole print is in view and lit. Deterministic by seed. Error: kValueOutOfRange where the plate is too
// large for the view.
Result<std::vector<Pose<frame::Belt, frame::Part>>> choose_plate_poses(const Rig& rig, const Plate& plate,
                                                                       PlatePoses how, int count, std::uint64_t seed);

}  // namespace beltpick::virtual_cell
