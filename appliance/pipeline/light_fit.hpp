// Where the light of a foreign cloud stood, told by the shadows in it.
#pragma once

#include <optional>
#include <span>

#include "base/arena.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/limits.hpp"
#include "result/shadow.hpp"

namespace beltpick::pipeline {

class LightFinder {
 public:
  LightFinder(Arena& arena, const Limits& limits);

  // The place, camera frame, from which the gaps in the range image are shadows on the belt and what was measured is
  // not; good in direction, its distance is taken to be the camera's. Nothing where no place explains most of the gaps,
  // or there are hardly any: a cloud by stereo or time of flight. Tries about a hundred places: some 0.3 s.
  std::optional<Vec3> find(const RangeImage& range, const Lens& lens, const std::optional<Plane>& belt);

 private:
  struct Place {
    double azimuth_rad, angle_rad;  // about the camera's line of sight to the middle, and away from it
    double merit = -1.0;
  };
  void gather(const RangeImage& range, const Lens& lens, const Plane& belt);
  [[nodiscard]] Vec3 position_mm(const Place& place) const;
  void rate(const RangeImage& range, const std::optional<Plane>& belt, Place& place);

  result::ShadowMap shadows_;
  std::span<Vec3f> dark_, measured_;  // on the belt where nothing was measured; what was
  std::size_t dark_count_ = 0, measured_count_ = 0;
  Vec3 middle_mm_ = Vec3::UnitZ();
  Vec3f belt_normal_ = -Vec3f::UnitZ();
};

}  // namespace beltpick::pipeline
