// The standards of trueness: ball bars, step wedges and planes, placed through the working volume by seed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.hpp"
#include "virtual_cell/render/target_scene.hpp"

namespace beltpick::virtual_cell {

struct BallBarOptions {
  double radius_mm = 20.0;
  double distance_mm = 120.0;  // between the centres of the two balls
};

struct StepOptions {
  int steps = 6;
  double rise_mm = 20.0;   // from step to step
  double width_mm = 48.0;  // of a step along the wedge
  double depth_mm = 90.0;  // across it
  double base_mm = 4.0;    // of the lowest step's top above the belt
};

// Where a plane lies: height above the belt in the middle of the view, and its tilt.
struct PlanePlace {
  double height_mm = 0.0;  // at least 3 mm, the plane's own thickness
  double tilt_deg = 0.0;
  double towards_deg = 0.0;  // direction on the belt that the plane falls to, from belt x
};

// Parts, and for each capture what of them stands where.
struct TargetStage {
  std::vector<ScenePart> parts;
  std::vector<TargetScene> scenes;
};

// Two balls over the belt, turned and inclined, wholly in view and lit. The heights of the balls' tops spread over
// 2 radii to 100 mm. Errors: kValueOutOfRange for balls that do not fit.
Result<TargetStage> make_ball_bars(const Rig& rig, const BallBarOptions& options, int count, std::uint64_t seed);

// A wedge of blocks on the belt, rising away from the projector so that no step shades the next. Errors:
// kValueOutOfRange for a wedge that is not in view or higher than the projector lights.
Result<TargetStage> make_step_wedges(const Rig& rig, const StepOptions& options, int count, std::uint64_t seed);

// A white plane through the whole view, at the given place, or at places spread by seed over 0..100 mm of height within
// the view: flat at the belt, at the top and in the middle first, then tilted to all sides.
Result<TargetStage> make_planes(const Rig& rig, const std::optional<PlanePlace>& place, int count, std::uint64_t seed);

}  // namespace beltpick::virtual_cell
