// Scene: what was measured, as the judges of a pose look at it.
#pragma once

#include <cstdint>
#include <optional>

#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "result/shadow.hpp"

namespace beltpick::result {

using PartPose = Pose<frame::Camera, frame::Part>;

struct Scene {
  RangeImage range;
  ImageView<const std::uint16_t> labels;  // the segments; 0 is the belt or nothing
  Lens lens;                              // that drew the range image: the camera's, or one fitted to a foreign cloud
  std::optional<Plane> belt;
  std::optional<Vec3> light_mm{};      // where the projector stands, camera frame, where known
  const ShadowMap* shadows = nullptr;  // that it cast, where they were looked for
  double noise_mm = 0.05;              // typical standard deviation of a measured point
};

// A rectangle of pixels, inclusive; may reach beyond the image.
struct Region {
  int row_min = 0, row_max = -1, col_min = 0, col_max = -1;
};

// How far a measured point may lie from the surface it is said to belong to: four standard deviations of its noise, and
// what a sampled template is off by between its points (the sagitta of a spacing on a radius of a few spacings).
inline double surface_tolerance_mm(const Scene& scene, double spacing_mm) {
  return 4.0 * scene.noise_mm + 0.15 * spacing_mm + 0.25;
}

// How far behind the surface a measurement must lie to prove that the surface is not there.
inline double free_space_tolerance_mm(const Scene& scene, double spacing_mm) {
  return 3.0 * surface_tolerance_mm(scene, spacing_mm) + spacing_mm;
}

}  // namespace beltpick::result
