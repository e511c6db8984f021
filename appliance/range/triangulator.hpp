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
#include "range/depth_curves.hpp"
#include "range/edge_filter.hpp"
#include "range/ray_curves.hpp"

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

  // The views stay good until the next call. Valid pixels of `code` that give no point get their reason in code.state:
  // kOrderUncertain where the geometry contradicts the code, kEdge where they fly. Where both axes are coded, the one
  // with the smaller predicted noise gives the point and the other one must agree with it. Error: kCalibrationMismatch
  // where the image's size is not the calibration's.
  Result<RangeImage> measure(const CodeImage& code);

  // The same in bands of rows, each while its codes still lie in the cache: begin() with the views of texture and state
  // of all rows, then measure_rows() for adjoining bands from row 0 to the last, where row 0 of `band` is row `first`;
  // the image is complete after that. Points come two rows late, since the row below tells where an edge is.
  // A further step on a row of depths goes into measure_row(), before edges_.push().
  Result<RangeImage> begin(const CodeImage& code);
  void measure_rows(const CodeImage& band, int first);

  // Complete after the last row.
  [[nodiscard]] const RangeCounts& counts() const { return counts_; }

 private:
  struct AxisScratch {
    std::span<float> depth_mm, sigma_mm, other_px, sigma_px;
  };
  // The depths of a row, kept until the next one is there to judge its edges, and their points until the one after that
  // gives the memory time to take them.
  struct DepthRow {
    std::span<float> depth_mm, sigma_mm;
  };
  DepthRow& depths_of(int row) { return depths_[static_cast<std::size_t>(row) % depths_.size()]; }
  [[nodiscard]] AxisInput input(Axis axis, const CodeImage& band, int band_row, int row) const;
  void measure_row(const CodeImage& band, int band_row, int row);
  // The depths of both axes, with the better one of each pixel in `out`.
  void measure_both(const CodeImage& band, int band_row, int row, const DepthRow& out);
  // Takes out what flies in a row; its points wait.
  void settle(int row, std::span<const std::uint8_t> flies);
  void write_waiting();

  int max_rows_, max_cols_;
  std::span<float> ray_u_, ray_v_;
  std::span<Vec3f> point_mm_;
  std::span<float> sigma_mm_;
  std::array<AxisScratch, 2> scratch_;  // by Axis
  std::array<DepthRow, 3> depths_;
  PointRow waiting_;  // settled, but not written; none where its depths are null
  EdgeFilter edges_;
  std::array<AxisModel, 2> models_;
  std::array<DepthCurves, 2> curves_;  // by Axis
  RayCurves rays_;
  std::array<bool, 2> by_curves_{};  // by Axis: they fit
  bool rays_by_curves_ = false;
  int rows_ = 0, cols_ = 0;
  float focal_px_ = 1.0F;
  ImageView<PixelState> state_;
  RangeCounts counts_;
};

}  // namespace beltpick::range
