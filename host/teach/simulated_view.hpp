// SimulatedView: the part alone on a belt as a range camera with a projector beside it would measure it. For teaching
// only: plain depth buffers, no light.
#pragma once

#include <optional>
#include <vector>

#include "contract/calibration.hpp"
#include "contract/mesh.hpp"
#include "contract/part_template.hpp"
#include "teach/surface.hpp"

namespace beltpick::teach {

using PartPose = Pose<frame::Camera, frame::Part>;

// What is drawn: triangles, three points each, part frame.
using Triangles = std::vector<Vec3f>;

// The faces of a mesh; of a scan, a small square at each point.
Triangles triangles_of(const Mesh& mesh, const Surface& surface);

struct SimulatedView {
  int rows = 0, cols = 0;
  std::vector<Vec3f> point_mm;         // camera frame, row-major; z = 0 where the light does not reach
  std::vector<OrientedPoint> of_part;  // the measured points on the part, camera frame, normals to the camera
  Lens lens;
  Vec3 projector_mm = Vec3::Zero();  // camera frame
  PartPose T_camera_part;            // the truth
};

// How a part lies there: standing on `down`, turned by turn_rad about the vertical, its centre so far from the middle.
struct Placement {
  Vec3 down = -Vec3::UnitZ();
  double turn_rad = 0.0;
  double x_mm = 0.0, y_mm = 0.0;
};

// A camera straight over the belt at 0.7 m (farther for parts that need it) with 400 x 300 mm in view, a projector 30
// degrees aside. `size_mm`: the part's diagonal; `noise_mm`: standard deviation along the ray. Deterministic.
SimulatedView simulate_view(const Triangles& triangles, double size_mm, const Placement& placement, double noise_mm,
                            std::uint64_t seed);

}  // namespace beltpick::teach
