// A bare point cloud as the range image of the camera that took it.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "contract/mesh.hpp"

namespace beltpick::scans {

// A range image that owns its points, and the lens that drew it.
struct Organised {
  std::vector<Vec3f> point_mm;
  int rows = 0, cols = 0;
  Lens lens;

  [[nodiscard]] RangeImage view() { return {{point_mm.data(), rows, cols}, {}, {}}; }
};

// Lays the points into pixels as far apart as the points are; the nearest one of a pixel stays. The points must lie in
// the frame of the camera that took them (z away from it). Errors: kFormatInvalid where they do not, kTooFewPoints;
// `name` is the file's.
Result<Organised> organise(const Mesh& cloud, const std::string& name);

}  // namespace beltpick::scans
