#include "pipeline/lens_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "contract/lens_project.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::pipeline {
namespace {

constexpr int kLeastPoints = 200;
constexpr double kLargestError_px = 2.0;
constexpr int kTerms = 7;

using Row = Eigen::Matrix<double, kTerms, 1>;

// Calls visit(column, row, x, y) for points spread over the image; x, y is the direction of sight at z = 1.
template <class Visit>
void visit_points(const RangeImage& range, Visit visit) {
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(range.point_mm.size()) / 40000.0)));
  for (int row = 0; row < range.point_mm.rows; row += step) {
    for (int col = 0; col < range.point_mm.cols; col += step) {
      if (!range.valid(row, col)) continue;
      const Vec3f& point = range.point_mm(row, col);
      const double z = point.z();
      visit(col, row, point.x() / z, point.y() / z);
    }
  }
}

// column = fx (x + k1 x r2 + k2 x r4 + k3 x r6 + p1 2xy + p2 (r2 + 2x2)) + cx is linear in its products with fx.
Row column_terms(double x, double y) {
  const double r2 = x * x + y * y;
  Row terms;
  terms << x, x * r2, x * r2 * r2, x * r2 * r2 * r2, 2.0 * x * y, r2 + 2.0 * x * x, 1.0;
  return terms;
}

Lens fit_columns(const RangeImage& range) {
  Eigen::Matrix<double, kTerms, kTerms> square = Eigen::Matrix<double, kTerms, kTerms>::Zero();
  Row right = Row::Zero();
  visit_points(range, [&](int col, int, double x, double y) {
    const Row terms = column_terms(x, y);
    square += terms * terms.transpose();
    right += terms * col;
  });
  // A ripple of regularisation: a small field of view does not determine the high orders.
  square.diagonal() *= 1.0 + 1e-9;
  const Row solution = square.ldlt().solve(right);
  Lens lens;
  lens.width = range.point_mm.cols;
  lens.height = range.point_mm.rows;
  lens.fx_px = solution[0];
  lens.cx_px = solution[6];
  lens.distortion = {solution[1] / solution[0], solution[2] / solution[0], solution[4] / solution[0],
                     solution[5] / solution[0], solution[3] / solution[0]};
  return lens;
}

void fit_rows(const RangeImage& range, Lens& lens) {
  lens.fy_px = 1.0;
  lens.cy_px = 0.0;
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  visit_points(range, [&](int, int row, double x, double y) {
    const Eigen::Vector2d terms(project(lens, {x, y, 1.0}).row_px, 1.0);
    square += terms * terms.transpose();
    right += terms * row;
  });
  const Eigen::Vector2d solution = square.ldlt().solve(right);
  lens.fy_px = solution[0];
  lens.cy_px = solution[1];
}

}  // namespace

Result<Lens> fit_lens(const RangeImage& range) {
  int points = 0;
  visit_points(range, [&](int, int, double, double) { ++points; });
  if (points < kLeastPoints) {
    return failure(ResultCode::kTooFewPoints, "cloud: %d points, expected at least %d; check the capture", points,
                   kLeastPoints);
  }
  Lens lens = fit_columns(range);
  fit_rows(range, lens);
  double square_px2 = 0.0;
  visit_points(range, [&](int col, int row, double x, double y) {
    const PixelPosition at = project(lens, {x, y, 1.0});
    square_px2 += (at.column_px - col) * (at.column_px - col) + (at.row_px - row) * (at.row_px - row);
  });
  const double rms_px = std::sqrt(square_px2 / points);
  const bool plausible = std::isfinite(rms_px) && lens.fx_px > 0.0 && lens.fy_px > 0.0 && rms_px < kLargestError_px;
  if (!plausible) {
    return failure(
        ResultCode::kFormatInvalid,
        "cloud: its points do not fall on their pixels through any lens (%.1f px RMS); expected an organised "
        "cloud with the origin at the optical centre",
        rms_px);
  }
  return lens;
}

}  // namespace beltpick::pipeline
