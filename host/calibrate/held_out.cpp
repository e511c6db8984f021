#include "calibrate/held_out.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "base/units.hpp"
#include "calibrate/rigid_fit.hpp"
#include "calibrate/triangulate.hpp"

namespace beltpick::calibrate {
namespace {

constexpr std::size_t kLeastCorners = 6;
constexpr int kHeldOutSteps = 12;

double along(const PixelPosition& at, Axis axis) { return axis == Axis::kColumn ? at.column_px : at.row_px; }

// A normal deviate from two uniform ones (Box and Muller).
double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * kPi * random.uniform());
}

struct Measurement {
  PixelPosition camera_px;
  double projector_px = 0.0;
  Vec3 point_mm;
};

// About `wanted` of the used corners, as the rig measures them.
std::vector<Measurement> sample_measurements(const Observations& seen, const Selection& use, const BundleState& state,
                                             Axis axis, std::size_t wanted) {
  std::vector<Measurement> all;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    for (std::size_t i = 0; i < seen.poses[p].corners.size(); ++i) {
      if (!use.has(p, i)) continue;
      const Vec3 point_mm = state.T_camera_plate[p] * state.plate_mm(seen.board, seen.poses[p].corners[i].corner);
      all.push_back({project(state.rig.camera, point_mm),
                     along(project(state.rig.projector, state.rig.T_projector_camera * point_mm), axis), point_mm});
    }
  }
  const std::size_t stride = std::max<std::size_t>(1, all.size() / wanted);
  std::vector<Measurement> some;
  for (std::size_t i = 0; i < all.size(); i += stride) some.push_back(all[i]);
  return some;
}

// Columns span the covariance: covariance = root * root^T.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

std::optional<MeasuredPlate> measure_plate(const Observations& seen, const Selection& use, const BundleState& state,
                                           std::size_t pose) {
  const Axis axis = sensitive_axis(state.rig);
  std::vector<Vec3> plate_mm, measured_mm;
  for (std::size_t i = 0; i < seen.poses[pose].corners.size(); ++i) {
    if (!use.corner[pose][i] || !use.projector[pose][i]) continue;
    const ObservedCorner& corner = seen.poses[pose].corners[i];
    const double guess_mm = state.T_camera_plate[pose].translation_mm.z();
    const auto point = triangulate(state.rig, corner.camera_px, axis, along(corner.projector_px, axis), guess_mm);
    if (!point) continue;
    plate_mm.push_back(state.plate_mm(seen.board, corner.corner));
    measured_mm.push_back(*point);
  }
  if (plate_mm.size() < kLeastCorners) return std::nullopt;
  const RigidFit fit = fit_rigid(plate_mm, measured_mm);
  MeasuredPlate result{0.0, 0.0, 1e6 * (fit.scale - 1.0), static_cast<int>(plate_mm.size())};
  for (std::size_t i = 0; i < plate_mm.size(); ++i) {
    const double off_mm = (fit * plate_mm[i] - measured_mm[i]).norm();
    result.rms_mm += off_mm * off_mm;
    result.max_mm = std::max(result.max_mm, off_mm);
  }
  result.rms_mm = std::sqrt(result.rms_mm / static_cast<double>(plate_mm.size()));
  return result;
}

std::vector<std::optional<MeasuredPlate>> hold_poses_out(const Observations& seen, const Selection& use,
                                                         const BundleNoise& noise, const BundleState& state,
                                                         const BundleOptions& options,
                                                         const std::function<void()>& done) {
  std::vector<std::optional<MeasuredPlate>> measured(seen.poses.size());
  BundleOptions shorter = options;
  shorter.max_steps = kHeldOutSteps;
  for (std::size_t p = 0; p < seen.poses.size(); ++p) {
    if (!use.pose[p]) continue;
    Selection others = use;
    others.pose[p] = false;
    const BundleResult without = refine(seen, others, noise, state, shorter);
    measured[p] = measure_plate(seen, use, without.state, p);
    if (done) done();
  }
  return measured;
}

PointSigma point_sigma(const Observations& seen, const Selection& use, const BundleState& state,
                       const Eigen::MatrixXd& rig_covariance) {
  constexpr int kDraws = 40;
  constexpr std::size_t kPoints = 150;
  const Axis axis = sensitive_axis(state.rig);
  const auto measurements = sample_measurements(seen, use, state, axis, kPoints);
  const Eigen::MatrixXd root = square_root(rig_covariance);
  std::vector<double> squares(measurements.size(), 0.0);
  Random random(1);
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd deviates(root.cols());
    for (double& deviate : deviates) deviate = normal(random);
    const Calibration rig = moved_rig(state.rig, root * deviates);
    std::vector<Vec3> from_mm, to_mm;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < measurements.size(); ++i) {
      const Measurement& m = measurements[i];
      const auto point = triangulate(rig, m.camera_px, axis, m.projector_px, m.point_mm.z());
      if (!point) continue;
      from_mm.push_back(*point);
      to_mm.push_back(m.point_mm);
      index.push_back(i);
    }
    if (from_mm.size() < kLeastCorners) return {1e9, 1e9};
    const RigidFit fit = fit_rigid(from_mm, to_mm);
    for (std::size_t i = 0; i < index.size(); ++i) squares[index[i]] += (fit * from_mm[i] - to_mm[i]).squaredNorm();
  }
  PointSigma sigma;
  for (const double sum : squares) {
    sigma.rms_mm += sum / kDraws / static_cast<double>(squares.size());
    sigma.max_mm = std::max(sigma.max_mm, std::sqrt(sum / kDraws));
  }
  sigma.rms_mm = std::sqrt(sigma.rms_mm);
  return sigma;
}

}  // namespace beltpick::calibrate
