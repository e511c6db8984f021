// From several scans of one part to one surface, with no start given: read this first.
//
//   cut_out        which object of a scan is the part; scan_view: its points, normals, noise, and what is empty space
//   pair_search    the ways in which two scans may lie on each other: pair_features votes, adjust aligns, agreement
//                  judges by shared surface and by what the other camera saw to be empty
//   join           the combination of pairs that fits as a whole
//   adjust         all scans against all others at once, point to plane, weighted by noise
//   merge          points that another scan refutes are dropped, the rest becomes one surface (moving least squares)
//   part_frame     where the part's origin lies; coverage: which sides no scan has seen
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "contract/mesh.hpp"
#include "scans/coverage.hpp"
#include "scans/scan_view.hpp"

namespace beltpick::scans {

inline constexpr std::size_t kMostScans = 24;

// How one scan took part.
struct ScanReport {
  std::string name;
  std::size_t points = 0;
  double noise_mm = 0.0;     // that was predicted of its points
  double residual_mm = 0.0;  // rms distance to the other scans where they overlap; 0 for a lone scan
  double shared = 0.0;       // greatest share of its points that lies on one other scan
  double alone = 0.0;        // share of the merged surface that only this scan has seen
  ScanPose T_part_scan{};    // its camera to the part frame
};

struct Stitched {
  Mesh surface;  // part frame (part_frame.hpp), points with outward normals, no faces
  std::vector<ScanReport> scans;
  std::vector<Side> missing;  // sides of which much is missing, worst first
  double residual_mm = 0.0;   // rms over all overlaps
  std::size_t dropped = 0;    // points that another scan saw to be empty space
  std::vector<std::string> warnings;
};

// Errors: as join(); kUsage for more than kMostScans; kResidualTooHigh where a scan lies off the others by more than
// its noise explains (it names scan and residual).
Result<Stitched> stitch(const std::vector<ScanView>& views, const std::function<void(int, int)>& done = {});

}  // namespace beltpick::scans
