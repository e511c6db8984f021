// Compares a measurement with the virtual cell's truth, pixel by pixel.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/quality/virtual_capture.hpp"

namespace beltpick::bench {

// What the truth says of a pixel.
struct PixelTruth {
  bool part = false;            // else the belt
  bool lit = false;             // the projector's light reaches it, within its image
  bool depth_band = false;      // within two pixels of a depth edge
  bool shadow_band = false;     // within two pixels of the border of the light
  float incidence_deg = 90.0F;  // the larger of those to camera and projector
};

// A depth edge parts two neighbouring pixels further apart along z than a surface at 80 degrees could climb.
std::vector<PixelTruth> truth_of(const VirtualCapture& capture);

struct Tally {
  std::int64_t lit = 0, points = 0;                    // apart from the depth band
  std::int64_t period_errors = 0;                      // of these points, off by more than half a period
  std::int64_t part_points = 0, part_off_half_mm = 0;  // on parts, apart from both bands
  std::int64_t band_points = 0, band_off = 0;          // within the depth band, off by more than 1 mm
  std::int64_t band_lit = 0;                           // pixels of the depth band that are lit
  std::int64_t eligible = 0, complete = 0;             // on parts, lit, below 70 degrees, apart from both bands
  std::int64_t shadow_points = 0, shadow_off = 0;      // within the shadow band only, off by more than 1 mm
  std::array<std::int64_t, 8> missing{};               // of `eligible`, by PixelState; kValid: dropped by range

  double ripple_px = 0.0, uncorrected_ripple_px = 0.0;  // not added up

  void add(const Tally& other);
};

Tally judge(const VirtualCapture& capture, const Measurement& measured, const std::vector<PixelTruth>& truth,
            double period_px);

// The part of the error that repeats with the fringe: RMS, in projector pixels, of the mean error by true phase, over
// tiles of the image; apart from both bands. Noise averages out.
double ripple_rms_px(const VirtualCapture& capture, const Measurement& measured, const std::vector<PixelTruth>& truth,
                     double period_px);

}  // namespace beltpick::bench
