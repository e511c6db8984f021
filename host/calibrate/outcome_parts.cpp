#include "calibrate/outcome_parts.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "calibrate/board_corners.hpp"
#include "calibrate/lens_derivatives.hpp"

namespace beltpick::calibrate {
namespace {

constexpr int kCameraColumns = 12, kCameraRows = 9;
constexpr int kProjectorColumns = 9, kProjectorRows = 9;
constexpr int kDepthSteps = 10;

PixelPosition pixel(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }

// Sums of squares, of 2-D residuals as OpenCV counts them.
struct Squares {
  double camera = 0.0, projector = 0.0, raw_projector = 0.0;
  int cameras = 0, projectors = 0;

  void add(const Squares& other) {
    camera += other.camera;
    projector += other.projector;
    raw_projector += other.raw_projector;
    cameras += other.cameras;
    projectors += other.projectors;
  }
  [[nodiscard]] double camera_rms() const { return cameras > 0 ? std::sqrt(camera / cameras) : 0.0; }
  [[nodiscard]] double projector_rms() const { return projectors > 0 ? std::sqrt(projector / projectors) : 0.0; }
  [[nodiscard]] double stereo_rms() const {
    return cameras + projectors > 0 ? std::sqrt((camera + raw_projector) / (cameras + projectors)) : 0.0;
  }
};

void gather_corners(const Observations& seen, const Selection& use, const BundleState& state, std::size_t p,
                    PoseOutcome& pose, Squares& squares) {
  for (std::size_t i = 0; i < seen.poses[p].corners.size(); ++i) {
    const ObservedCorner& observed = seen.poses[p].corners[i];
    const BundleResidual residual = residual_of(seen, state, p, i);
    CornerOutcome corner;
    corner.corner = observed.corner;
    corner.camera_px = observed.camera_px;
    corner.projector_px = observed.projector_px;
    corner.camera_residual_px = pixel(residual.camera_px);
    corner.projector_residual_px = pixel(residual.projector_px);
    corner.used = use.has(p, i) && use.projector[p][i];
    pose.corners.push_back(corner);
    if (use.has(p, i)) {
      squares.camera += residual.camera_px.squaredNorm();
      ++squares.cameras;
      if (!use.projector[p][i]) continue;
      squares.projector += residual.projector_px.squaredNorm();
      squares.raw_projector +=
          (residual.projector_px + observed.projector_by_camera * residual.camera_px).squaredNorm();
      ++squares.projectors;
    }
  }
}

void place(const Board& board, const PlatePosition& position, PoseOutcome& pose) {
  const Vec3 middle =
      position * Vec3(0.5 * (board.columns - 1) * board.square_mm, 0.5 * (board.rows - 1) * board.square_mm, 0.0);
  const Vec3 normal = position.rotation.col(2);
  pose.T_camera_plate = position;
  pose.distance_mm = middle.z();
  pose.tilt_x_deg = deg_from_rad(std::atan2(normal.y(), normal.z()));
  pose.tilt_y_deg = deg_from_rad(std::atan2(normal.x(), normal.z()));
}

void count_in(CoverageGrid& grid, const PixelPosition& at, int width, int height) {
  const int column = static_cast<int>(std::floor((at.column_px + 0.5) * grid.columns / width));
  const int row = static_cast<int>(std::floor((at.row_px + 0.5) * grid.rows / height));
  if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) return;
  ++grid.counts[static_cast<std::size_t>(row * grid.columns + column)];
}

CoverageGrid empty_grid(int columns, int rows) {
  return {columns, rows, std::vector<int>(static_cast<std::size_t>(columns * rows), 0)};
}

Coverage coverage_of(const Observations& seen, const Outcome& outcome, const BundleState& state) {
  Coverage coverage{.camera = empty_grid(kCameraColumns, kCameraRows),
                    .projector = empty_grid(kProjectorColumns, kProjectorRows),
                    .depth_counts = std::vector<int>(kDepthSteps, 0)};
  std::vector<double> depths_mm, tilts_x, tilts_y;
  for (const PoseOutcome& pose : outcome.poses) {
    if (!pose.used) continue;
    tilts_x.push_back(pose.tilt_x_deg);
    tilts_y.push_back(pose.tilt_y_deg);
    for (const CornerOutcome& corner : pose.corners) {
      if (!corner.used) continue;
      count_in(coverage.camera, corner.camera_px, seen.camera_width, seen.camera_height);
      count_in(coverage.projector, corner.projector_px, seen.projector.width, seen.projector.height);
      depths_mm.push_back((pose.T_camera_plate * state.plate_mm(seen.board, corner.corner)).z());
    }
  }
  if (depths_mm.empty()) return coverage;
  const auto range = [](const std::vector<double>& v) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    return std::pair(*low, *high);
  };
  std::tie(coverage.near_mm, coverage.far_mm) = range(depths_mm);
  coverage.tilt_x_range_deg = range(tilts_x).second - range(tilts_x).first;
  coverage.tilt_y_range_deg = range(tilts_y).second - range(tilts_y).first;
  const double step_mm = std::max(coverage.far_mm - coverage.near_mm, 1e-9) / kDepthSteps;
  for (const double depth_mm : depths_mm) {
    const int step = std::min(kDepthSteps - 1, static_cast<int>((depth_mm - coverage.near_mm) / step_mm));
    ++coverage.depth_counts[static_cast<std::size_t>(step)];
  }
  return coverage;
}

std::vector<ParameterOutcome> parameters_of(const Calibration& rig, const Eigen::MatrixXd& covariance) {
  constexpr const char* kLensNames[] = {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
  std::vector<ParameterOutcome> parameters;
  const auto sigma = [&](int i) { return std::sqrt(std::max(covariance(i, i), 0.0)); };
  for (int lens = 0; lens < 2; ++lens) {
    const LensVector values = vector_of(lens == 0 ? rig.camera : rig.projector);
    for (int i = 0; i < kLensParameters; ++i) {
      parameters.push_back({std::string(lens == 0 ? "camera " : "projector ") + kLensNames[i], i < 4 ? "px" : "",
                            values[i], sigma(kLensParameters * lens + i)});
    }
  }
  constexpr const char* kAxes[] = {"x", "y", "z"};
  const Eigen::AngleAxisd turn(rig.T_projector_camera.rotation);
  for (int i = 0; i < 3; ++i) {
    parameters.push_back({std::string("rotation ") + kAxes[i], "deg", deg_from_rad(turn.angle() * turn.axis()[i]),
                          deg_from_rad(sigma(18 + i))});
  }
  for (int i = 0; i < 3; ++i) {
    parameters.push_back(
        {std::string("translation ") + kAxes[i], "mm", rig.T_projector_camera.translation_mm[i], sigma(21 + i)});
  }
  return parameters;
}

PlateShape shape_of(const Observations& seen, const BundleState& state, std::vector<double> sigma_mm) {
  const auto [low, high] = std::minmax_element(state.height_mm.begin(), state.height_mm.end());
  return {state.height_mm, std::move(sigma_mm), *high - *low, is_symmetric(seen.board)};
}

void add_held_out(const std::vector<std::optional<MeasuredPlate>>& held_out, Outcome& outcome) {
  double squares = 0.0, sizes = 0.0;
  int corners = 0, poses = 0;
  for (std::size_t p = 0; p < held_out.size(); ++p) {
    if (!held_out[p]) continue;
    const MeasuredPlate& plate = *held_out[p];
    PoseOutcome& pose = outcome.poses[p];
    pose.held_out = true;
    pose.held_out_rms_mm = plate.rms_mm;
    pose.held_out_max_mm = plate.max_mm;
    pose.held_out_size_ppm = plate.size_ppm;
    squares += plate.rms_mm * plate.rms_mm * plate.corners;
    sizes += plate.size_ppm * plate.size_ppm;
    corners += plate.corners;
    ++poses;
    outcome.held_out_max_mm = std::max(outcome.held_out_max_mm, plate.max_mm);
  }
  if (poses == 0) return;
  outcome.held_out_rms_mm = std::sqrt(squares / corners);
  outcome.held_out_size_ppm = std::sqrt(sizes / poses);
}

}  // namespace

Outcome gather(const Observations& seen, const Selection& use, const BundleResult& solution,
               const std::vector<std::optional<MeasuredPlate>>& held_out) {
  const BundleState& state = solution.state;
  Outcome outcome;
  outcome.calibration = state.rig;
  outcome.board = seen.board;
  Squares all;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    PoseOutcome pose;
    pose.capture = seen.poses[p].capture;
    pose.used = use.pose[p];
    place(seen.board, state.T_camera_plate[p], pose);
    Squares squares;
    gather_corners(seen, use, state, p, pose, squares);
    pose.camera_rms_px = squares.camera_rms();
    pose.projector_rms_px = squares.projector_rms();
    pose.stereo_rms_px = squares.stereo_rms();
    all.add(squares);
    outcome.poses_used += pose.used ? 1 : 0;
    for (const CornerOutcome& corner : pose.corners) {
      outcome.corners_used += corner.used ? 1 : 0;
      outcome.corners_left_out += pose.used && !corner.used ? 1 : 0;
    }
    outcome.poses.push_back(std::move(pose));
  }
  outcome.camera_rms_px = all.camera_rms();
  outcome.projector_rms_px = all.projector_rms();
  outcome.stereo_rms_px = all.stereo_rms();
  outcome.coverage = coverage_of(seen, outcome, state);
  BundleSigmas sigmas = sigmas_of(seen, solution);
  outcome.parameters = parameters_of(state.rig, sigmas.rig_covariance);
  outcome.plate = shape_of(seen, state, std::move(sigmas.height_mm));
  const PointSigma points = point_sigma(seen, use, state, sigmas.rig_covariance);
  outcome.point_sigma_mm = points.rms_mm;
  outcome.point_sigma_max_mm = points.max_mm;
  add_held_out(held_out, outcome);
  return outcome;
}

void name_left_out(Outcome& outcome) {
  for (const LeftOut& item : outcome.left_out) {
    for (PoseOutcome& pose : outcome.poses) {
      if (pose.capture != item.capture) continue;
      if (item.corner < 0) pose.reason = item.reason;
      for (CornerOutcome& corner : pose.corners) {
        if (corner.corner == item.corner) corner.reason = item.reason;
      }
    }
  }
}

}  // namespace beltpick::calibrate
