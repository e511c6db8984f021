#include "calibrate/bundle.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calibrate/board_corners.hpp"
#include "calibrate/bundle_priors.hpp"
#include "calibrate/lens_derivatives.hpp"

namespace beltpick::calibrate {
namespace {

using Eigen::Index;

constexpr double kHuber = 2.5;
constexpr double kConverged = 1e-9;  // of the cost, for three steps
constexpr int kPoseParameters = 6;

Mat3 turned(const Vec3& turn, const Mat3& rotation) {
  const double angle = turn.norm();
  return angle > 0.0 ? Mat3(Eigen::AngleAxisd(angle, turn / angle) * rotation) : rotation;
}

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// One corner's residuals with their derivatives by its 31 parameters: rig 24, pose 6, height 1.
struct CornerRows {
  static constexpr int kCount = kRigParameters + kPoseParameters + 1;
  BundleResidual residual;
  Eigen::Matrix<double, 4, kCount> by = Eigen::Matrix<double, 4, kCount>::Zero();
  bool in_front = false;
};

CornerRows rows_of(const Board& board, const ObservedCorner& seen, const BundleState& state, std::size_t pose) {
  CornerRows rows;
  const PlatePosition& position = state.T_camera_plate[pose];
  const Vec3 plate_mm = state.plate_mm(board, seen.corner);
  const Vec3 rotated = position.rotation * plate_mm;
  const Vec3 camera_mm = rotated + position.translation_mm;
  const auto& stereo = state.rig.T_projector_camera;
  const Vec3 rotated_projector = stereo.rotation * camera_mm;
  const Vec3 projector_mm = rotated_projector + stereo.translation_mm;
  rows.in_front = camera_mm.z() > 0.0 && projector_mm.z() > 0.0;
  if (!rows.in_front) return rows;

  const ProjectedPoint camera = project_with_derivatives(state.rig.camera, camera_mm);
  Eigen::Matrix<double, 3, 7> point_by;  // pose: turn, shift; height
  point_by << -cross_matrix(rotated), Mat3::Identity(), -position.rotation.col(2);
  Eigen::Matrix<double, 2, CornerRows::kCount> camera_by = Eigen::Matrix<double, 2, CornerRows::kCount>::Zero();
  camera_by.leftCols<9>() = camera.by_lens;
  camera_by.rightCols<7>() = camera.by_point * point_by;
  rows.residual.camera_px = Eigen::Vector2d(seen.camera_px.column_px, seen.camera_px.row_px) - camera.at_px;
  rows.by.topRows<2>() = -camera_by;
  if (!seen.has_projector()) return rows;

  const ProjectedPoint light = project_with_derivatives(state.rig.projector, projector_mm);
  Eigen::Matrix<double, 2, CornerRows::kCount> light_by = Eigen::Matrix<double, 2, CornerRows::kCount>::Zero();
  light_by.middleCols<9>(9) = light.by_lens;
  light_by.middleCols<3>(18) = -light.by_point * cross_matrix(rotated_projector);
  light_by.middleCols<3>(21) = light.by_point;
  light_by.rightCols<7>() = light.by_point * stereo.rotation * point_by;
  rows.residual.projector_px = Eigen::Vector2d(seen.projector_px.column_px, seen.projector_px.row_px) - light.at_px -
                               seen.projector_by_camera * rows.residual.camera_px;
  rows.by.bottomRows<2>() = seen.projector_by_camera * camera_by - light_by;
  return rows;
}

double huber_weight(double size) { return size <= kHuber ? 1.0 : kHuber / size; }
double huber_cost(double size) { return size <= kHuber ? 0.5 * size * size : kHuber * (size - 0.5 * kHuber); }

// Where parameters stand in the system: rig, poses, heights. Corners that half a turn exchanges share a height.
struct Layout {
  std::vector<Index> pose_at;
  std::vector<Index> height_at;  // by corner; -1: heights stay
  Index size = kRigParameters;

  Layout(const Observations& seen, bool plate_shape) {
    pose_at.resize(seen.poses.size());
    for (Index& at : pose_at) at = std::exchange(size, size + kPoseParameters);
    const int corners = seen.board.corners();
    height_at.assign(static_cast<std::size_t>(corners), -1);
    if (!plate_shape) return;
    for (int c = 0; c < corners; ++c) {
      const int twin = is_symmetric(seen.board) ? corners - 1 - c : c;
      height_at[static_cast<std::size_t>(c)] = twin < c ? height_at[static_cast<std::size_t>(twin)] : size++;
    }
  }
};

class Problem {
 public:
  Problem(const Observations& seen, const Selection& use, const BundleNoise& noise, const BundleState& start,
          const BundleOptions& options)
      : seen_(seen), use_(use), noise_(noise), layout_(seen, options.plate_shape) {
    priors_ = rig_priors(seen, start.rig);
    if (options.plate_shape) add_shape_priors(seen.board, priors_);
  }

  [[nodiscard]] Index size() const { return layout_.size; }

  [[nodiscard]] double cost(const BundleState& state) const {
    double sum = 0.0;
    for_corners([&](std::size_t p, std::size_t i) {
      const CornerRows rows = rows_of(seen_.board, seen_.poses[p].corners[i], state, p);
      if (!rows.in_front) sum += 1e12;
      const auto [camera, light] = sizes(rows.residual);
      sum += huber_cost(camera) + (use_.projector[p][i] ? huber_cost(light) : 0.0);
    });
    for (const Prior& prior : priors_) sum += 0.5 * square(prior.residual(value_of(state)));
    return sum;
  }

  void build(const BundleState& state, Eigen::MatrixXd& normal, Eigen::VectorXd& gradient) const {
    normal.setZero(size(), size());
    gradient.setZero(size());
    for_corners([&](std::size_t p, std::size_t i) { add_corner(state, p, i, normal, gradient); });
    for (std::size_t p = 0; p < seen_.poses.size(); ++p) {
      if (!use_.pose[p]) normal.diagonal().segment<kPoseParameters>(layout_.pose_at[p]).setOnes();
    }
    const auto values = value_of(state);
    for (const Prior& prior : priors_) {
      for (const auto& [a, weight_a] : prior.terms) {
        gradient[at(a)] += weight_a * prior.residual(values);
        for (const auto& [b, weight_b] : prior.terms) normal(at(a), at(b)) += weight_a * weight_b;
      }
    }
  }

  [[nodiscard]] BundleState moved(const BundleState& state, const Eigen::VectorXd& step) const {
    BundleState next = state;
    next.rig = moved_rig(state.rig, step.head<kRigParameters>());
    for (std::size_t p = 0; p < next.T_camera_plate.size(); ++p) {
      if (!use_.pose[p]) continue;
      const auto part = step.segment<kPoseParameters>(layout_.pose_at[p]);
      PlatePosition& pose = next.T_camera_plate[p];
      pose.rotation = turned(part.head<3>(), pose.rotation);
      pose.translation_mm += part.tail<3>();
    }
    for (std::size_t c = 0; c < next.height_mm.size(); ++c) {
      if (layout_.height_at[c] >= 0) next.height_mm[c] += step[layout_.height_at[c]];
    }
    return next;
  }

 private:
  static double square(double v) { return v * v; }

  template <class Visit>
  void for_corners(Visit visit) const {
    for (std::size_t p = 0; p < seen_.poses.size(); ++p) {
      for (std::size_t i = 0; i < seen_.poses[p].corners.size(); ++i) {
        if (use_.has(p, i)) visit(p, i);
      }
    }
  }

  [[nodiscard]] std::pair<double, double> sizes(const BundleResidual& residual) const {
    return {residual.camera_px.norm() / noise_.camera_px, residual.projector_px.norm() / noise_.projector_px};
  }

  // Priors speak of the rig's parameters and, after them, of the corners' heights.
  [[nodiscard]] Index at(int parameter) const {
    return parameter < kRigParameters ? parameter
                                      : layout_.height_at[static_cast<std::size_t>(parameter - kRigParameters)];
  }

  [[nodiscard]] PriorValues value_of(const BundleState& state) const {
    return {vector_of(state.rig.camera), vector_of(state.rig.projector), state.height_mm};
  }

  void add_corner(const BundleState& state, std::size_t p, std::size_t i, Eigen::MatrixXd& normal,
                  Eigen::VectorXd& gradient) const {
    const ObservedCorner& corner = seen_.poses[p].corners[i];
    const CornerRows rows = rows_of(seen_.board, corner, state, p);
    if (!rows.in_front) return;
    const auto [camera_size, light_size] = sizes(rows.residual);
    Eigen::Vector4d weight;
    weight.head<2>().setConstant(huber_weight(camera_size) / square(noise_.camera_px));
    weight.tail<2>().setConstant(use_.projector[p][i] ? huber_weight(light_size) / square(noise_.projector_px) : 0.0);
    Eigen::Vector4d residual;
    residual << rows.residual.camera_px, rows.residual.projector_px;
    const Eigen::Matrix<double, CornerRows::kCount, 4> weighted = rows.by.transpose() * weight.asDiagonal();
    const Eigen::Matrix<double, CornerRows::kCount, CornerRows::kCount> block = weighted * rows.by;
    const Eigen::Matrix<double, CornerRows::kCount, 1> slope = weighted * residual;
    std::array<Index, CornerRows::kCount> place{};
    std::iota(place.begin(), place.begin() + kRigParameters, 0);
    std::iota(place.begin() + kRigParameters, place.end() - 1, layout_.pose_at[p]);
    place.back() = layout_.height_at[static_cast<std::size_t>(corner.corner)];
    const int count = place.back() < 0 ? CornerRows::kCount - 1 : CornerRows::kCount;
    for (int a = 0; a < count; ++a) {
      gradient[place[static_cast<std::size_t>(a)]] += slope[a];
      for (int b = 0; b < count; ++b) {
        normal(place[static_cast<std::size_t>(a)], place[static_cast<std::size_t>(b)]) += block(a, b);
      }
    }
  }

  const Observations& seen_;
  const Selection& use_;
  BundleNoise noise_;
  Layout layout_;
  std::vector<Prior> priors_;
};

}  // namespace

BundleResidual residual_of(const Observations& seen, const BundleState& state, std::size_t pose, std::size_t corner) {
  return rows_of(seen.board, seen.poses[pose].corners[corner], state, pose).residual;
}

Calibration moved_rig(const Calibration& rig, const Eigen::VectorXd& step) {
  Calibration next = rig;
  next.camera = lens_of(vector_of(rig.camera) + step.head<9>(), rig.camera);
  next.projector = lens_of(vector_of(rig.projector) + step.segment<9>(9), rig.projector);
  next.T_projector_camera.rotation = turned(step.segment<3>(18), rig.T_projector_camera.rotation);
  next.T_projector_camera.translation_mm += step.segment<3>(21);
  return next;
}

BundleResult refine(const Observations& seen, const Selection& use, const BundleNoise& noise, BundleState start,
                    const BundleOptions& options) {
  const Problem problem(seen, use, noise, start, options);
  BundleResult result{std::move(start), false, {}};
  Eigen::VectorXd gradient;
  double cost = problem.cost(result.state);
  double damping = 1e-4;
  int still = 0;
  for (int step = 0; step < options.max_steps && still < 2; ++step) {
    problem.build(result.state, result.information, gradient);
    bool better = false;
    for (int attempt = 0; attempt < 10 && !better; ++attempt) {
      Eigen::MatrixXd damped = result.information;
      damped.diagonal() *= 1.0 + damping;
      const BundleState next = problem.moved(result.state, damped.ldlt().solve(-gradient));
      const double next_cost = problem.cost(next);
      better = next_cost < cost;  // false for NaN too
      damping = better ? std::max(damping * 0.1, 1e-12) : damping * 10.0;
      if (!better) continue;
      still = cost - next_cost < kConverged * cost ? still + 1 : 0;
      cost = next_cost;
      result.state = next;
    }
    if (!better) still = 2;
  }
  result.converged = still >= 2;
  problem.build(result.state, result.information, gradient);
  return result;
}

BundleSigmas sigmas_of(const Observations& seen, const BundleResult& result) {
  const Layout layout(
      seen, result.information.rows() > kRigParameters + kPoseParameters * static_cast<Index>(seen.poses.size()));
  const Eigen::MatrixXd covariance =
      result.information.ldlt().solve(Eigen::MatrixXd::Identity(layout.size, layout.size));
  BundleSigmas sigmas;
  sigmas.rig_covariance = covariance.topLeftCorner<kRigParameters, kRigParameters>();
  for (const Index at : layout.height_at)
    sigmas.height_mm.push_back(at < 0 ? 0.0 : std::sqrt(std::max(covariance(at, at), 0.0)));
  return sigmas;
}

}  // namespace beltpick::calibrate
