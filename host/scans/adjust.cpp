#include "scans/adjust.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace beltpick::scans {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr float kFacing = 0.6F;
constexpr double kDamping = 1e-6;
constexpr double kSettled_mm = 1e-4;

// What all pairs between two scans ask of their relative motion.
struct Sums {
  Mat6 information = Mat6::Zero();
  Vec6 gradient = Vec6::Zero();
  int pairs = 0;
  double weight = 0.0, weighted_square = 0.0;
};

// Pairs points of `from` with the surface of `to`; motions are of `from` in the part frame about `centre`.
void pair_up(const ScanView& from, const ScanPose& T_part_from, const ScanView& to, const ScanPose& T_part_to,
             const AdjustStage& stage, const Vec3& centre, Sums& sums) {
  const CrossPose T_to_from = T_part_to.inverse() * T_part_from;
  const Eigen::Matrix3f rotation = T_to_from.rotation.cast<float>();
  const Vec3f translation = T_to_from.translation_mm.cast<float>();
  const double lateral = std::max(2.0 * to.spacing_mm, stage.radius_mm);
  for (std::size_t i = 0; i < std::min(stage.points, from.point.size()); ++i) {
    const Vec3f at = rotation * from.point[i].point_mm + translation;
    const std::size_t hit = to.grid.nearest(at);
    const OrientedPoint& near = to.point[hit];
    const Vec3f apart = at - near.point_mm;
    const double off = static_cast<double>(near.normal.dot(apart));
    if (std::abs(off) >= stage.radius_mm || static_cast<double>(apart.squaredNorm()) > lateral * lateral + off * off)
      continue;
    const float facing = near.normal.dot(rotation * from.point[i].normal);
    if (facing < kFacing) continue;
    const double share = off / stage.radius_mm;
    const double tukey = (1.0 - share * share) * (1.0 - share * share);
    const double sigma = std::hypot(static_cast<double>(from.sigma_mm[i]), static_cast<double>(to.sigma_mm[hit]));
    const double weight = tukey * static_cast<double>(facing) / (sigma * sigma);
    const Vec3 normal = T_part_to.rotation * near.normal.cast<double>();
    const Vec3 arm = T_part_to * at.cast<double>() - centre;
    Vec6 row;
    row << arm.cross(normal), normal;
    sums.information.noalias() += weight * row * row.transpose();
    sums.gradient += weight * off * row;
    sums.weight += weight;
    sums.weighted_square += weight * off * off;
    ++sums.pairs;
  }
}

Vec3 centre_of(const ScanView& view, const ScanPose& T_part_scan) {
  Vec3f sum = Vec3f::Zero();
  const std::size_t count = std::min<std::size_t>(500, view.point.size());
  for (std::size_t i = 0; i < count; ++i) sum += view.point[i].point_mm;
  return T_part_scan * (sum / static_cast<float>(count)).cast<double>();
}

ScanPose moved(const ScanPose& pose, const Vec6& step, const Vec3& centre) {
  const Vec3 turn = step.head<3>();
  const double angle = turn.norm();
  const Mat3 rotation = angle < 1e-15 ? Mat3(Mat3::Identity()) : Eigen::AngleAxisd(angle, turn / angle).matrix();
  const Pose<frame::Part, frame::Part> motion{rotation, centre + Vec3(step.tail<3>()) - rotation * centre};
  ScanPose next = motion * pose;
  next.rotation = Eigen::Quaterniond(next.rotation).normalized().toRotationMatrix();
  return next;
}

// The system of all scans but the first; unknowns are their motions.
class System {
 public:
  System(std::size_t views, double radius_mm)
      : information_(Eigen::MatrixXd::Zero(size(views), size(views))),
        gradient_(Eigen::VectorXd::Zero(size(views))),
        radius_mm_(radius_mm) {}

  // A residual depends on the difference of both motions alone.
  void add(std::size_t from, std::size_t to, const Sums& sums) {
    block(from, from) += sums.information;
    block(to, to) += sums.information;
    block(from, to) -= sums.information;
    block(to, from) -= sums.information;
    gradient_.segment<6>(at(from)) += sums.gradient;
    gradient_.segment<6>(at(to)) -= sums.gradient;
  }

  // The motion of every scan; the first stays.
  [[nodiscard]] Eigen::VectorXd solve() const {
    const Eigen::Index free = gradient_.size() - 6;
    Eigen::MatrixXd matrix = information_.bottomRightCorner(free, free);
    // Rotations as lengths at the rim, so that one damping fits all.
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(free);
    for (Eigen::Index i = 0; i < free; i += 6) scale.segment<3>(i).setConstant(1.0 / radius_mm_);
    matrix = scale.asDiagonal() * matrix * scale.asDiagonal();
    matrix.diagonal().array() += kDamping * matrix.diagonal().maxCoeff() + 1e-12;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(gradient_.size());
    step.tail(free) = -scale.cwiseProduct(matrix.ldlt().solve(scale.cwiseProduct(gradient_.tail(free))));
    return step;
  }

 private:
  static Eigen::Index size(std::size_t views) { return static_cast<Eigen::Index>(6 * views); }
  static Eigen::Index at(std::size_t view) { return static_cast<Eigen::Index>(6 * view); }
  Eigen::Block<Eigen::MatrixXd, 6, 6> block(std::size_t row, std::size_t col) {
    return information_.block<6, 6>(at(row), at(col));
  }

  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  double radius_mm_;
};

double rms_mm(const Sums& sums) { return sums.weight > 0.0 ? std::sqrt(sums.weighted_square / sums.weight) : 0.0; }

// One step. Returns how far it moved what, in mm at the rim; fills `ties` anew.
double iterate(std::span<const ScanView* const> views, std::span<ScanPose> poses, const AdjustStage& stage,
               std::vector<Tie>& ties) {
  const Vec3 centre = centre_of(*views[0], poses[0]);
  const double rim_mm = 0.5 * views[0]->diagonal_mm;
  System system(views.size(), rim_mm);
  ties.clear();
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = i + 1; j < views.size(); ++j) {
      Sums forth;
      Sums back;
      pair_up(*views[i], poses[i], *views[j], poses[j], stage, centre, forth);
      pair_up(*views[j], poses[j], *views[i], poses[i], stage, centre, back);
      system.add(i, j, forth);
      system.add(j, i, back);
      forth.pairs += back.pairs;
      forth.weight += back.weight;
      forth.weighted_square += back.weighted_square;
      if (forth.pairs > 0) ties.push_back({i, j, forth.pairs, rms_mm(forth)});
    }
  }
  const Eigen::VectorXd step = system.solve();
  double farthest_mm = 0.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const Vec6 own = step.segment<6>(static_cast<Eigen::Index>(6 * i));
    poses[i] = moved(poses[i], own, centre);
    farthest_mm = std::max(farthest_mm, own.head<3>().norm() * rim_mm + own.tail<3>().norm());
  }
  return farthest_mm;
}

}  // namespace

std::vector<Tie> adjust(std::span<const ScanView* const> views, std::span<ScanPose> T_part_scan,
                        std::span<const AdjustStage> stages) {
  std::vector<Tie> ties;
  if (views.size() < 2) return ties;
  for (const AdjustStage& stage : stages) {
    for (int i = 0; i < stage.iterations; ++i) {
      if (iterate(views, T_part_scan, stage, ties) < kSettled_mm) break;
    }
  }
  return ties;
}

}  // namespace beltpick::scans
