// Triangulator: projector coordinates to an ordered range image in the camera frame, with the noise that each point
// must be expected to have. Allocates nothing after construction.
#pragma once

#include <array>
#include <span>

#include "base/arena.hpp"
#include "base/result.hpp"
#include "base/stages.hpp"
#include "contract/calibration.hpp"
#include "range/axis_kernel.hpp"
#include "range/edge_filter.hpp"

namespace beltpick::range {

// How many pixels of a code image became points, and why the others did not.
struct RangeCounts {
  int points = 0;
  int outside_projector = 0;  // the point would lie outside what the projector lights, or behind a lens
  int axes_disagree = 0;      // column and row codes contradict each other
  int flying = 0;             // mixtures of two depths at an edge
};

class Triangulator {
 public:
  // Room for cameras of up to rows x cols.
  Triangulator(Arena& arena, int rows, int cols);

  // Makes the table of camera rays; takes a tenth of a second, so between captures. Error: kLimitExceeded.
  Result<void> load(const Calibration& calibration);

  // The views stay good until the next call. Where both axes are coded, the one with the smaller predicted noise gives
  // the point and the other one must agree with it. Error: kCalibrationMismatch where the image's size is not the
  // calibration's.
  Result<RangeImage> measure(const CodeImage& code);

  [[nodiscard]] const RangeCounts& counts() const { return counts_; }

 private:
  struct AxisScratch {
    std::span<float> depth_mm, mm_per_px, other_px, sigma_px, sigma_mm;
  };
  void measure_axis(Axis axis, const CodeImage& code, int row);
  // Brings the better axis of each pixel into the columns' scratch.
  void choose_axis(const CodeImage& code, int row);

  int max_rows_, max_cols_;
  std::span<float> ray_u_, ray_v_;
  std::span<Vec3f> point_mm_;
  std::span<float> sigma_mm_;
  std::array<AxisScratch, 2> scratch_;  // by Axis
  EdgeFilter edges_;
  std::array<AxisModel, 2> models_;
  std::array<int, 2> extent_px_{};  // of the projector, by Axis
  int rows_ = 0, cols_ = 0;
  float focal_px_ = 1.0F;
  RangeCounts counts_;
};

}  // namespace beltpick::range
