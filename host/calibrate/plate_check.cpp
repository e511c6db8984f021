#include "calibrate/plate_check.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/units.hpp"
#include "calibrate/rigid_fit.hpp"
#include "calibrate/triangulate.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kFewestCorners = 12;
// A plate that fits worse than this is not the plate: another board, another rig, corners mixed up.
constexpr double kAnotherPlate = 0.05;  // of its diagonal

double coordinate(const PixelPosition& pixel, Axis axis) {
  return axis == Axis::kColumn ? pixel.column_px : pixel.row_px;
}

// The axis to measure by: the rig's own, or the only one that is coded.
Axis coded_axis(const Calibration& calibration, std::span<const SeenCorner> corners) {
  const Axis best = sensitive_axis(calibration);
  const Axis other = best == Axis::kColumn ? Axis::kRow : Axis::kColumn;
  const bool coded = std::any_of(corners.begin(), corners.end(), [&](const SeenCorner& corner) {
    return !std::isnan(coordinate(corner.projector_px, best));
  });
  return coded ? best : other;
}

std::vector<SeenCorner> measurable(const Calibration& calibration, std::span<const SeenCorner> corners,
                                   std::vector<MeasuredCorner>& measured) {
  const Axis axis = coded_axis(calibration, corners);
  const double guess_mm =
      crossing_depth_mm(calibration).value_or(2.0 * calibration.T_projector_camera.translation_mm.norm());
  std::vector<SeenCorner> kept;
  for (const SeenCorner& corner : corners) {
    const double code_px = coordinate(corner.projector_px, axis);
    if (std::isnan(code_px)) continue;
    const auto point_mm = triangulate(calibration, corner.camera_px, axis, code_px, guess_mm);
    if (!point_mm) continue;
    kept.push_back(corner);
    measured.push_back({corner.plate_mm, *point_mm, 0.0, {}});
  }
  return kept;
}

struct PointPairs {
  std::vector<Vec3> plate_mm, point_mm;
};

PointPairs pairs_of(const std::vector<MeasuredCorner>& corners) {
  PointPairs pairs;
  for (const MeasuredCorner& corner : corners) {
    pairs.plate_mm.push_back(corner.plate_mm);
    pairs.point_mm.push_back(corner.point_mm);
  }
  return pairs;
}

double diagonal_mm(const std::vector<Vec3>& plate_mm) {
  Vec3 low = plate_mm.front(), high = plate_mm.front();
  for (const Vec3& point_mm : plate_mm) {
    low = low.cwiseMin(point_mm);
    high = high.cwiseMax(point_mm);
  }
  return (high - low).norm();
}

// Sets above_mm; the rms of it.
double measure_flatness(std::vector<MeasuredCorner>& corners) {
  Vec3 mean = Vec3::Zero();
  for (const MeasuredCorner& corner : corners) mean += corner.point_mm;
  mean /= static_cast<double>(corners.size());
  Mat3 square = Mat3::Zero();
  for (const MeasuredCorner& corner : corners) {
    square += (corner.point_mm - mean) * (corner.point_mm - mean).transpose();
  }
  Vec3 normal = Eigen::JacobiSVD<Mat3>(square, Eigen::ComputeFullU).matrixU().col(2);
  if (normal.dot(mean) > 0.0) normal = -normal;
  double sum = 0.0;
  for (MeasuredCorner& corner : corners) {
    corner.above_mm = normal.dot(corner.point_mm - mean);
    sum += corner.above_mm * corner.above_mm;
  }
  return std::sqrt(sum / static_cast<double>(corners.size()));
}

// From the lowest to the highest place of the second-order surface through above_mm: what is left when noise is
// averaged over the plate.
double bow_mm(const std::vector<MeasuredCorner>& corners, double diagonal) {
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(corners.size()), 6);
  Eigen::VectorXd heights(terms.rows());
  for (Eigen::Index i = 0; i < terms.rows(); ++i) {
    const MeasuredCorner& corner = corners[static_cast<std::size_t>(i)];
    const double x = corner.plate_mm.x() / diagonal, y = corner.plate_mm.y() / diagonal;
    terms.row(i) << 1.0, x, y, x * x, x * y, y * y;
    heights[i] = corner.above_mm;
  }
  const Eigen::VectorXd smooth = terms * terms.colPivHouseholderQr().solve(heights);
  return smooth.maxCoeff() - smooth.minCoeff();
}

double neighbour_rms_mm(const std::vector<MeasuredCorner>& corners, double square_mm) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      const double known_mm = (corners[i].plate_mm - corners[j].plate_mm).norm();
      if (known_mm > 1.2 * square_mm) continue;
      const double off_mm = (corners[i].point_mm - corners[j].point_mm).norm() - known_mm;
      sum += off_mm * off_mm;
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

double rms_px(const std::vector<CornerResidual>& residuals, PixelPosition CornerResidual::*view) {
  double sum = 0.0;
  for (const CornerResidual& residual : residuals) {
    const PixelPosition& px = residual.*view;
    if (!std::isnan(px.column_px)) sum += px.column_px * px.column_px;
    if (!std::isnan(px.row_px)) sum += px.row_px * px.row_px;
  }
  return std::sqrt(sum / static_cast<double>(residuals.size()));
}

PixelPosition mean_shift_px(const std::vector<CornerResidual>& residuals) {
  PixelPosition sum;
  for (const CornerResidual& residual : residuals) {
    sum.column_px += residual.projector_px.column_px;
    sum.row_px += residual.projector_px.row_px;
  }
  const auto count = static_cast<double>(residuals.size());
  return {sum.column_px / count, sum.row_px / count};
}

// How much farther the measured corners are than the plate that the camera alone sees.
double distance_error_mm(const std::vector<MeasuredCorner>& corners, const PlatePose& camera_alone) {
  double sum = 0.0;
  for (const MeasuredCorner& corner : corners) {
    sum += corner.point_mm.norm() - (camera_alone.T_camera_plate * corner.plate_mm).norm();
  }
  return sum / static_cast<double>(corners.size());
}

std::unexpected<Error> not_this_plate(double off_mm) {
  return failure(ResultCode::kCalibrationMismatch,
                 "what was measured fits no such plate (%.2f mm rms); check --board and --square-mm, and that the "
                 "calibration is of this rig; if all are right, calibrate anew",
                 off_mm);
}

void judge(PlateCheck& check, const Calibration& calibration, double local_rms_mm, double flat_rms_mm, double bow,
           const PlateTolerance& tolerance) {
  const double camera_mm = check.camera_rms_px * check.distance_mm / calibration.camera.fx_px;
  const double projector_mm =
      check.projector_rms_px * check.distance_mm / std::min(calibration.projector.fx_px, calibration.projector.fy_px);
  check.figures = {
      {"neighbours", "distances of neighbouring corners, rms error", local_rms_mm, tolerance.local_mm},
      {"flatness", "corners to the plane through them, rms", flat_rms_mm, tolerance.local_mm},
      {"bow", "bow of the plate as measured, from lowest to highest", bow, tolerance.plate_mm},
      {"size", "size of the plate, error over its diagonal", std::abs(check.size_error_mm), tolerance.plate_mm},
      {"distance", "distance of the plate, against what the camera alone tells", std::abs(check.distance_error_mm),
       tolerance.plate_mm},
      {"camera", "corners in the camera, rms at the plate", camera_mm, tolerance.plate_mm},
      {"projector", "corners in the projector, rms at the plate", projector_mm, tolerance.plate_mm}};
}

}  // namespace

bool PlateCheck::good() const {
  return std::all_of(figures.begin(), figures.end(), [](const CheckedFigure& figure) { return figure.good(); });
}

std::string PlateCheck::verdict() const {
  if (good()) return "in tolerance";
  const auto share = [](const CheckedFigure& figure) { return figure.value_mm / figure.limit_mm; };
  const auto worst = std::max_element(figures.begin(), figures.end(),
                                      [&](const auto& a, const auto& b) { return share(a) < share(b); });
  const auto bad = std::count_if(figures.begin(), figures.end(), [](const auto& figure) { return !figure.good(); });
  std::array<char, 200> words{};
  std::snprintf(words.data(), words.size(), "out of tolerance: %s %.3f mm (at most %.3f)", worst->meaning.c_str(),
                worst->value_mm, worst->limit_mm);
  return words.data() + (bad > 1 ? ", and " + std::to_string(bad - 1) + " more" : std::string());
}

std::vector<SeenCorner> seen_corners(const Board& board, const ObservedPose& pose) {
  std::vector<SeenCorner> corners;
  for (const ObservedCorner& corner : pose.corners) {
    if (corner.has_projector())
      corners.push_back({board.flat_mm(corner.corner), corner.camera_px, corner.projector_px});
  }
  return corners;
}

Result<PlateCheck> check_plate(const Calibration& calibration, std::span<const SeenCorner> corners, double square_mm,
                               const PlateTolerance& tolerance) {
  PlateCheck check;
  const std::vector<SeenCorner> kept = measurable(calibration, corners, check.corners);
  if (kept.size() < kFewestCorners) {
    return failure(ResultCode::kTooFewPoints,
                   "%zu corners of the plate can be measured, at least %d are needed; show the whole plate, lit and "
                   "in view of both camera and projector",
                   kept.size(), kFewestCorners);
  }
  const PointPairs pairs = pairs_of(check.corners);
  const RigidFit fit = fit_rigid(pairs.plate_mm, pairs.point_mm);
  const double diagonal = diagonal_mm(pairs.plate_mm);
  double sum = 0.0;
  for (const MeasuredCorner& corner : check.corners) sum += (fit * corner.plate_mm - corner.point_mm).squaredNorm();
  const double off_mm = std::sqrt(sum / static_cast<double>(kept.size()));
  if (!(off_mm < kAnotherPlate * diagonal)) return not_this_plate(off_mm);
  check.size_error_mm = (fit.scale - 1.0) * diagonal;

  const PlatePosition start{fit.rotation, fit.translation_mm};
  const auto camera_alone = fit_plate_pose(calibration, kept, Views::kCamera, start);
  const auto both = fit_plate_pose(calibration, kept, Views::kBoth, start);
  if (!camera_alone || !both) return not_this_plate(off_mm);
  check.T_camera_plate = both->T_camera_plate;
  for (std::size_t i = 0; i < kept.size(); ++i) check.corners[i].residual = both->residuals[i];
  check.distance_error_mm = distance_error_mm(check.corners, *camera_alone);
  check.projector_shift_px = mean_shift_px(camera_alone->residuals);
  check.camera_rms_px = rms_px(both->residuals, &CornerResidual::camera_px);
  check.projector_rms_px = rms_px(both->residuals, &CornerResidual::projector_px);
  Vec3 middle_mm = Vec3::Zero();
  for (const Vec3& point_mm : pairs.point_mm) middle_mm += point_mm;
  check.distance_mm = middle_mm.z() / static_cast<double>(kept.size());
  check.tilt_deg = deg_from_rad(std::acos(std::min(1.0, std::abs(fit.rotation(2, 2)))));
  const double flat_rms_mm = measure_flatness(check.corners);
  judge(check, calibration, neighbour_rms_mm(check.corners, square_mm), flat_rms_mm, bow_mm(check.corners, diagonal),
        tolerance);
  return check;
}

}  // namespace beltpick::calibrate
