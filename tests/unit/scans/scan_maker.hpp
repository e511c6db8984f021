// Scans of a mesh as an ideal camera takes them: rays against triangles, on a belt.
#pragma once

#include <vector>

#include "contract/mesh.hpp"
#include "scans/scan_view.hpp"

namespace beltpick::test {

// A range image of a 160 x 120 camera 500 mm above a belt, 1 mm a pixel there.
struct SmallScan {
  std::vector<Vec3f> point_mm;
  std::vector<std::uint16_t> label;
  Lens lens;

  [[nodiscard]] scans::ScanSource source(const std::string& name);
  [[nodiscard]] scans::CutOut part() const;
};

// The mesh in a pose whose lowest point lies on the belt (the pose's height does not matter), `noise_mm` along the
// ray. Adds the pose that was taken.
SmallScan take_scan(const Mesh& mesh, const Mat3& rotation, double noise_mm, std::uint64_t seed,
                    Pose<frame::Camera, frame::Part>& T_camera_part);

}  // namespace beltpick::test
