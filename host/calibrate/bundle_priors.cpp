#include "calibrate/bundle_priors.hpp"

#include <algorithm>

namespace beltpick::calibrate {
namespace {

// Standard deviations of what the terms of k1, k2, p1, p2, k3 move the outermost corner by, of its distance from the
// principal point: far above those of lenses that one would measure with.
constexpr double kTermSigma[] = {0.3, 0.1, 0.01, 0.01, 0.03};
constexpr int kTermPower[] = {2, 4, 1, 1, 6};
constexpr double kCameraCentreSigma = 0.1;     // of the image's width, height
constexpr double kProjectorCentreSigma = 0.5;  // projectors look past their lens's axis
constexpr double kBendSigma = 1e-3;            // second difference of neighbouring heights, of a square
constexpr double kGaugeSigma = 1e-4;           // of a square: mean, tilt

void add_lens(const Lens& lens, double reach, double centre_sigma, int first, std::vector<Prior>& priors) {
  const auto put = [&](int parameter, double expected, double sigma) {
    priors.push_back({{{first + parameter, 1.0 / sigma}}, expected / sigma});
  };
  put(2, (lens.width - 1) / 2.0, centre_sigma * lens.width);
  put(3, (lens.height - 1) / 2.0, centre_sigma * lens.height);
  for (int term = 0; term < 5; ++term) put(4 + term, 0.0, kTermSigma[term] / std::pow(reach, kTermPower[term]));
}

// The outermost corner seen, in normalised coordinates.
double reach_of(const Lens& lens, const std::vector<PixelPosition>& seen) {
  double reach = 0.05;
  for (const PixelPosition& at : seen) {
    reach =
        std::max(reach, std::hypot((at.column_px - lens.cx_px) / lens.fx_px, (at.row_px - lens.cy_px) / lens.fy_px));
  }
  return reach;
}

}  // namespace

std::vector<Prior> rig_priors(const Observations& seen, const Calibration& start) {
  std::vector<PixelPosition> camera, projector;
  for (const ObservedPose& pose : seen.poses) {
    for (const ObservedCorner& corner : pose.corners) {
      camera.push_back(corner.camera_px);
      if (corner.has_projector()) projector.push_back(corner.projector_px);
    }
  }
  std::vector<Prior> priors;
  add_lens(start.camera, reach_of(start.camera, camera), kCameraCentreSigma, 0, priors);
  add_lens(start.projector, reach_of(start.projector, projector), kProjectorCentreSigma, kLensParameters, priors);
  return priors;
}

void add_shape_priors(const Board& board, std::vector<Prior>& priors) {
  constexpr int kFirst = 2 * kLensParameters + 6;
  const double per_bend = 1.0 / (kBendSigma * board.square_mm);
  const auto at = [&](int column, int row) { return kFirst + row * board.columns + column; };
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if (column >= 1 && column + 1 < board.columns) {
        priors.push_back(
            {{{at(column - 1, row), per_bend}, {at(column, row), -2.0 * per_bend}, {at(column + 1, row), per_bend}}});
      }
      if (row >= 1 && row + 1 < board.rows) {
        priors.push_back(
            {{{at(column, row - 1), per_bend}, {at(column, row), -2.0 * per_bend}, {at(column, row + 1), per_bend}}});
      }
      if (column >= 1 && row >= 1) {
        priors.push_back({{{at(column - 1, row - 1), per_bend},
                           {at(column, row), per_bend},
                           {at(column - 1, row), -per_bend},
                           {at(column, row - 1), -per_bend}}});
      }
    }
  }
  const double per_gauge = 1.0 / (kGaugeSigma * board.square_mm * board.corners());
  Prior mean, along_columns, along_rows;
  for (int corner = 0; corner < board.corners(); ++corner) {
    const double x = 2.0 * board.column_of(corner) / (board.columns - 1) - 1.0;
    const double y = 2.0 * board.row_of(corner) / (board.rows - 1) - 1.0;
    mean.terms.emplace_back(kFirst + corner, per_gauge);
    along_columns.terms.emplace_back(kFirst + corner, per_gauge * x);
    along_rows.terms.emplace_back(kFirst + corner, per_gauge * y);
  }
  priors.push_back(std::move(mean));
  priors.push_back(std::move(along_columns));
  priors.push_back(std::move(along_rows));
}

}  // namespace beltpick::calibrate
