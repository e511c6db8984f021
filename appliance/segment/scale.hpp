// Scale: how far apart neighbouring pixels see and how noisy they are, told by the range image itself.
#pragma once

#include "base/stages.hpp"

namespace beltpick::segment {

struct Scale {
  double pitch_rad = 0.0;  // angle between neighbouring lines of sight: at range z, pixels lie pitch_rad * z apart
  double noise_mm = 0.0;   // standard deviation along the line of sight, at `noise_z_mm`
  double noise_z_mm = 1.0;
  double poor_sigma_mm = 0.0;  // a predicted sigma above this marks a poor measurement; 0 where none is predicted

  [[nodiscard]] double pitch_mm(double z_mm) const { return pitch_rad * z_mm; }
  // Triangulating cameras: noise grows with the square of the distance.
  [[nodiscard]] double sigma_mm(double z_mm) const { return noise_mm * (z_mm / noise_z_mm) * (z_mm / noise_z_mm); }
  // The threshold d of equation (2): a surface leaning by 80 degrees still holds together, and so does noise.
  [[nodiscard]] double step_mm(double z_mm) const { return 6.0 * pitch_mm(z_mm) + 4.0 * sigma_mm(z_mm); }
};

// Measures the scale on a lattice of about 20,000 pixels. pitch_rad is 0 where too few neighbours were measured.
Scale measure_scale(const RangeImage& range);

}  // namespace beltpick::segment
