// The same job by OpenCV's vectorised calls, whole images at a time: what it would take without kernels of one's own.
#pragma once

#include "bench/decode/job.hpp"

namespace beltpick::bench {

struct OpencvTimes {
  double ms = 0.0;  // median pass
  // How far its results are from the kernels', over the pixels that both measured.
  double worst_code_px = 0.0;   // 99.99 % of them
  double worst_depth_mm = 0.0;  // 99.99 % of them
  double share_both = 0.0;      // of the pixels that the kernels measured
};

// For captures of one period of column fringes, one Gray code, white and black. Rays and epipolar lines of the pixels
// come from a table made beforehand; flying pixels are not looked for. One thread.
OpencvTimes time_opencv(const Loaded& loaded, const Calibration& calibration, const Job& reference, int passes);

}  // namespace beltpick::bench
