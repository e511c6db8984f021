// One surface from several scans in one frame.
#pragma once

#include <span>

#include "contract/mesh.hpp"
#include "scans/scan_view.hpp"

namespace beltpick::scans {

struct Merged {
  Mesh surface;               // points with outward normals, no faces; part frame
  std::size_t dropped = 0;    // points that another scan saw to be empty space
  double noise_mm = 0.0;      // of the scans' points about the merged surface, rms
  std::vector<double> added;  // the share of the surface that a scan alone has seen, one a scan
};

// Points within `radius_mm` and facing alike are one piece of surface: a plane through them, weighted by their noise
// and nearness (moving least squares), moves each point onto it. Points that stand in the free space of another scan
// are dropped first.
Merged merge(std::span<const ScanView> views, std::span<const ScanPose> T_part_scan);

}  // namespace beltpick::scans
