// Test scenes: parts on a belt, seen by a camera with a distorting lens and lit from the side, with noise and gaps; the
// truth beside it. By sphere tracing, slow and obvious.
#pragma once

#include <memory>
#include <vector>

#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "support/scenes/shapes.hpp"

namespace beltpick::test {

struct Placed {
  const Shape* shape;
  Pose<frame::Camera, frame::Part> T_camera_part;
};

struct SceneOptions {
  int width = 640, height = 480;
  double focal_px = 1120.0;  // 400 x 300 mm at 700 mm
  double noise_mm = 0.05;
  double gap_share = 0.01;  // of pixels not measured
  bool shadows = true;      // of a projector 30 degrees to the left
  std::uint64_t seed = 1;
};

struct SceneImage {
  std::vector<Vec3f> point_mm;
  std::vector<float> sigma_mm;
  std::vector<std::uint16_t> label;  // 1.. in the order of the parts; 0 belt or nothing
  std::vector<Segment> segments;
  Lens lens;
  Plane belt;

  [[nodiscard]] RangeImage range() {
    return {{point_mm.data(), lens.height, lens.width}, {sigma_mm.data(), lens.height, lens.width}, {}};
  }
  [[nodiscard]] ImageView<std::uint16_t> labels() { return {label.data(), lens.height, lens.width}; }
  // Gives all pixels of label `from` the label `to`, as when a segmentation fails to part two objects.
  void merge(std::uint16_t from, std::uint16_t to);
  // Finds boxes and counts of the segments anew from the labels.
  void recount();
};

// The belt of all scenes, 700 mm away, leaning by 6 degrees.
Plane scene_belt();

// Where the light of all scenes stands, camera frame.
Vec3 scene_light_mm();

// A pose with the given rotation (belt frame's z up) whose lowest point lies on the belt at (x, y) mm from its middle.
Pose<frame::Camera, frame::Part> on_belt(const Shape& shape, const PartTemplate& part, const Mat3& rotation_belt_part,
                                         double x_mm, double y_mm);

// A rotation drawn uniformly.
Mat3 any_rotation(std::uint64_t seed);

SceneImage render(const std::vector<Placed>& parts, const SceneOptions& options = {});

}  // namespace beltpick::test
