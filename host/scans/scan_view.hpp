// ScanView: one scan of the part as registration uses it: the part's points with their normals and noise, and what else
// the camera saw (the belt, free space).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/closest_point_grid.hpp"
#include "base/pose.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "scans/cut_out.hpp"
#include "scans/free_space.hpp"

namespace beltpick::scans {

// From a scan's camera to the common frame of all scans, mm.
using ScanPose = Pose<frame::Part, frame::Camera>;
// From one scan's camera to another's.
using CrossPose = Pose<frame::Camera, frame::Camera>;

struct ScanView {
  std::string name;                  // the file's, for messages
  std::vector<OrientedPoint> point;  // of the part; camera frame; in random order: any first part of it is a sample
  std::vector<float> sigma_mm;       // standard deviation along the line of sight, one a point
  double spacing_mm = 1.0;           // typical distance between neighbouring points
  double diagonal_mm = 1.0;          // of what is seen of the part
  double noise_mm = 0.05;            // median of sigma_mm
  FreeSpace seen;
  std::optional<Plane> belt;
  bool cut = false;  // by the image's border

  [[nodiscard]] const OrientedPoint& nearest(const Vec3f& at_camera_mm) const {
    return point[grid.nearest(at_camera_mm)];
  }
  ClosestPointGrid grid;
  std::vector<std::uint16_t> grid_cells;

  ScanView() = default;
  ScanView(ScanView&&) = default;
  ScanView& operator=(ScanView&&) = default;
  ScanView(const ScanView&) = delete;
  ScanView& operator=(const ScanView&) = delete;
};

// What is known of the scan besides its range image.
struct ScanSource {
  std::string name;
  RangeImage range;
  Lens lens;
  ImageView<const std::uint16_t> labels;
  std::optional<Plane> belt;
};

// Takes the part's points. Copies: the source may go. Errors: kTooFewPoints where hardly anything of the part was
// measured.
Result<ScanView> make_view(const ScanSource& source, const CutOut& part);

}  // namespace beltpick::scans
