// FreeSpace: what a camera has seen to be empty: the space in front of everything it measured, belt included.
#pragma once

#include <vector>

#include "base/stages.hpp"
#include "contract/calibration.hpp"

namespace beltpick::scans {

class FreeSpace {
 public:
  FreeSpace() = default;
  // Copies what it needs. `pixel_mm`: how far apart neighbouring pixels see.
  FreeSpace(const RangeImage& range, const Lens& lens, double pixel_mm);

  // How far in front of the measured surface a point stands, mm along the line of sight: where that is positive the
  // camera should have seen it and has not. The nearest depth within about 2 mm to the side counts, so that a pose that
  // is a little off contradicts nothing; 0 or less where too little was measured round the place to tell.
  [[nodiscard]] double in_front_mm(const Vec3& point_camera_mm) const;

 private:
  Lens lens_;
  int cell_px_ = 1;
  int rows_ = 0, cols_ = 0;
  std::vector<float> nearest_mm_;  // camera z, a cell and its neighbours; 0: not known
};

}  // namespace beltpick::scans
