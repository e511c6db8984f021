#include "bench/calibration/targets.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/units.hpp"

namespace beltpick::bench {
namespace {

struct PlaneFit {
  Vec3 mean_mm, normal;
};

Vec3 mean_of(const std::vector<Vec3>& points_mm) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& point_mm : points_mm) sum += point_mm;
  return sum / static_cast<double>(points_mm.size());
}

Mat3 scatter_of(const std::vector<Vec3>& points_mm, const Vec3& mean_mm) {
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& point_mm : points_mm) scatter += (point_mm - mean_mm) * (point_mm - mean_mm).transpose();
  return scatter;
}

// The direction across which the points spread least, towards the camera.
Vec3 normal_of(const Mat3& scatter) {
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(scatter).eigenvectors().col(0);
  return normal.z() > 0.0 ? Vec3(-normal) : normal;
}

// Points farther from the plane than this many times the rms are left out once: a flying pixel, dust.
std::vector<Vec3> without_outliers(const std::vector<Vec3>& points_mm) {
  constexpr double kOutlier = 4.0;
  const Vec3 mean_mm = mean_of(points_mm);
  const Mat3 scatter = scatter_of(points_mm, mean_mm);
  const Vec3 normal = normal_of(scatter);
  const double rms_mm = std::sqrt(normal.dot(scatter * normal) / static_cast<double>(points_mm.size()));
  std::vector<Vec3> kept;
  for (const Vec3& point_mm : points_mm) {
    if (std::abs(normal.dot(point_mm - mean_mm)) <= kOutlier * rms_mm) kept.push_back(point_mm);
  }
  return kept;
}

// One Gauss-Newton step of a ball through the points; their rms distance to the surface before it.
double ball_step(const std::vector<Vec3>& points_mm, Ball& ball) {
  Mat4 normal = Mat4::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double sum = 0.0;
  for (const Vec3& point_mm : points_mm) {
    const Vec3 off_mm = point_mm - ball.centre_mm;
    const double residual = off_mm.norm() - ball.radius_mm;
    Eigen::Vector4d row;
    row << -off_mm.normalized(), -1.0;
    normal += row * row.transpose();
    right -= residual * row;
    sum += residual * residual;
  }
  const Eigen::Vector4d step = normal.ldlt().solve(right);
  ball.centre_mm += step.head<3>();
  ball.radius_mm += step[3];
  return std::sqrt(sum / static_cast<double>(points_mm.size()));
}

}  // namespace

TargetPoints points_of(ImageView<const float> xyz, ImageView<const std::uint16_t> instances, int instance,
                       int edge_px) {
  TargetPoints found;
  const auto inside = [&](int row, int col) {
    for (int dr = -edge_px; dr <= edge_px; dr += edge_px) {
      for (int dc = -edge_px; dc <= edge_px; dc += edge_px) {
        const int r = row + dr, c = col + dc;
        if (r < 0 || c < 0 || r >= instances.rows || c >= instances.cols || instances(r, c) != instance) return false;
      }
    }
    return true;
  };
  for (int row = 0; row < instances.rows; ++row) {
    for (int col = 0; col < instances.cols; ++col) {
      if (instances(row, col) != instance || !inside(row, col)) continue;
      const Vec3 point_mm(static_cast<double>(xyz(row, 3 * col)), static_cast<double>(xyz(row, 3 * col + 1)),
                          static_cast<double>(xyz(row, 3 * col + 2)));
      if (!(point_mm.z() > 0.0)) continue;
      found.point_mm.push_back(point_mm);
      found.row.push_back(row);
      found.col.push_back(col);
    }
  }
  return found;
}

PlaneTrueness judge_plane(const TargetPoints& points, int block_px) {
  struct Block {
    double sum = 0.0, square = 0.0;
    int count = 0;
  };
  const std::vector<Vec3> kept = without_outliers(points.point_mm);
  const Vec3 mean_mm = mean_of(kept);
  const Vec3 normal = normal_of(scatter_of(kept, mean_mm));
  std::map<std::pair<int, int>, Block> blocks;
  for (std::size_t i = 0; i < points.point_mm.size(); ++i) {
    Block& block = blocks[{points.row[i] / block_px, points.col[i] / block_px}];
    const double height_mm = normal.dot(points.point_mm[i] - mean_mm);
    block.sum += height_mm;
    block.square += height_mm * height_mm;
    ++block.count;
  }
  PlaneTrueness trueness;
  double low_pass = 0.0, noise = 0.0;
  int used = 0;
  for (const auto& [place, block] : blocks) {
    if (2 * block.count < block_px * block_px) continue;
    const double mean = block.sum / block.count;
    low_pass += mean * mean;
    noise += block.square - block.count * mean * mean;
    used += block.count;
    trueness.low_pass_max_mm = std::max(trueness.low_pass_max_mm, std::abs(mean));
    ++trueness.blocks;
  }
  if (trueness.blocks == 0) return trueness;
  trueness.low_pass_rms_mm = std::sqrt(low_pass / trueness.blocks);
  trueness.noise_rms_mm = std::sqrt(noise / used);
  return trueness;
}

Ball fit_ball(const TargetPoints& points, const Vec3& start_mm, double max_incidence_deg) {
  constexpr int kRounds = 12;
  Ball ball{start_mm, (points.point_mm.front() - start_mm).norm(), 0.0};
  const double least_cosine = std::cos(rad_from_deg(max_incidence_deg));
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Vec3> kept;
    for (const Vec3& point_mm : points.point_mm) {
      const Vec3 off_mm = point_mm - ball.centre_mm;
      if (-off_mm.normalized().dot(point_mm.normalized()) < least_cosine) continue;
      if (round > 3 && std::abs(off_mm.norm() - ball.radius_mm) > 3.0 * ball.rms_mm) continue;
      kept.push_back(point_mm);
    }
    ball.rms_mm = ball_step(kept, ball);
  }
  return ball;
}

std::vector<double> step_heights_mm(const std::vector<TargetPoints>& steps) {
  Mat3 scatter = Mat3::Zero();
  std::vector<Vec3> means_mm;
  for (const TargetPoints& step : steps) {
    const std::vector<Vec3> kept = without_outliers(step.point_mm);
    means_mm.push_back(mean_of(kept));
    scatter += scatter_of(kept, means_mm.back());
  }
  const Vec3 normal = normal_of(scatter);
  std::vector<double> heights_mm;
  for (const Vec3& mean_mm : means_mm) heights_mm.push_back(normal.dot(mean_mm - means_mm.front()));
  return heights_mm;
}

}  // namespace beltpick::bench
