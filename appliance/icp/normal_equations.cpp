#include "icp/normal_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/kernel.hpp"
#include "contract/find_nearest.hpp"

namespace beltpick::icp {
namespace {

constexpr int kLanes = PointBlock::kLanes;
using Lane = std::array<float, kLanes>;

// Tukey's biweight: 1 at no distance, 0 from the radius on.
float tukey_weight(float distance2, float radius2) {
  const float rest = 1.0F - distance2 / radius2;
  return rest > 0.0F ? rest * rest : 0.0F;
}

void add_row(NormalEquations& system, const Vec3& arm, const Vec3& normal, double residual, double weight) {
  Vec6 row;
  row << arm.cross(normal), normal;
  const Vec6 weighted = weight * row;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) system.information(i, j) += weighted[i] * row[j];
  }
  system.gradient += weighted * residual;
}

// What is added up over the points, each of kLanes sums by itself: so the order of addition does not depend on the
// vector unit. Single precision holds for the points of one block, double for the blocks.
struct Sums {
  static constexpr int kInformation = 0;  // lower triangle, row by row
  static constexpr int kGradient = 21;
  static constexpr int kWeight = 27;
  static constexpr int kSquare = 28;
  static constexpr int kInliers = 29;
  static constexpr int kCount = 30;

  alignas(64) std::array<float, static_cast<std::size_t>(kCount) * kLanes> block;
  alignas(64) std::array<double, static_cast<std::size_t>(kCount) * kLanes> all{};

  [[nodiscard]] double of(int sum) const {
    double total = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) total += all[static_cast<std::size_t>(sum * kLanes + lane)];
    return total;
  }
};

// The stage's plain numbers.
struct Rule {
  float radius2, facing, aside, beyond;
  float centre[3];
};

// kLanes rows of the system: direction in which the distance is measured, arm x direction before it, and the distance.
struct Rows {
  alignas(64) std::array<Lane, 6> jacobian;
  alignas(64) Lane residual, weight;
};

[[gnu::always_inline]] inline void add_rows(const Rows& rows, float* __restrict sums) {
  float* __restrict to = sums;
  for (std::size_t i = 0; i < 6; ++i) {
    alignas(64) Lane weighted;
    for (std::size_t k = 0; k < kLanes; ++k) weighted[k] = rows.weight[k] * rows.jacobian[i][k];
    for (std::size_t j = 0; j <= i; ++j, to += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) to[k] += weighted[k] * rows.jacobian[j][k];
    }
    float* __restrict gradient = sums + (Sums::kGradient + i) * kLanes;
    for (std::size_t k = 0; k < kLanes; ++k) gradient[k] += weighted[k] * rows.residual[k];
  }
}

// The pairs of kLanes measured points (`at`, part frame) with the surface points nearest to them.
[[gnu::always_inline]] inline void add_pairs(const PointBlock& at, const PointBlock& near, const Rule& rule,
                                             std::size_t first, float* __restrict sums) {
  Rows rows, rows_beyond;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const std::size_t p = first + k;
    const float nx = near.nx[p], ny = near.ny[p], nz = near.nz[p];
    const float dx = at.x[p] - near.x[p], dy = at.y[p] - near.y[p], dz = at.z[p] - near.z[p];
    const float residual = nx * dx + ny * dy + nz * dz;
    const float sx = dx - residual * nx, sy = dy - residual * ny, sz = dz - residual * nz;
    const float sideways = std::sqrt(sx * sx + sy * sy + sz * sz);
    const float out = sideways - rule.aside;
    const float beyond = out > 0.0F ? out : 0.0F;
    const float rest = 1.0F - (residual * residual + beyond * beyond) / rule.radius2;
    const bool counts = nx * at.nx[p] + ny * at.ny[p] + nz * at.nz[p] >= rule.facing && rest > 0.0F;
    const float weight = counts ? rest * rest : 0.0F;
    const float ax = at.x[p] - rule.centre[0], ay = at.y[p] - rule.centre[1], az = at.z[p] - rule.centre[2];
    rows.jacobian[0][k] = ay * nz - az * ny;
    rows.jacobian[1][k] = az * nx - ax * nz;
    rows.jacobian[2][k] = ax * ny - ay * nx;
    rows.jacobian[3][k] = nx, rows.jacobian[4][k] = ny, rows.jacobian[5][k] = nz;
    rows.residual[k] = residual;
    rows.weight[k] = weight;
    sums[Sums::kWeight * kLanes + k] += weight;
    sums[Sums::kSquare * kLanes + k] += weight * residual * residual;
    sums[Sums::kInliers * kLanes + k] += counts ? 1.0F : 0.0F;
    const float per_length = beyond > 0.0F ? 1.0F / sideways : 0.0F;
    const float ux = sx * per_length, uy = sy * per_length, uz = sz * per_length;
    rows_beyond.jacobian[0][k] = ay * uz - az * uy;
    rows_beyond.jacobian[1][k] = az * ux - ax * uz;
    rows_beyond.jacobian[2][k] = ax * uy - ay * ux;
    rows_beyond.jacobian[3][k] = ux, rows_beyond.jacobian[4][k] = uy, rows_beyond.jacobian[5][k] = uz;
    rows_beyond.residual[k] = beyond;
    rows_beyond.weight[k] = rule.beyond * weight;
  }
  add_rows(rows, sums);
  if (rule.beyond > 0.0F) add_rows(rows_beyond, sums);
}

BELTPICK_KERNEL void add_block(const PointBlock& at, const PointBlock& near, const Rule& rule, int count, Sums& sums) {
  sums.block.fill(0.0F);
  for (int i = 0; i < count; i += kLanes) add_pairs(at, near, rule, static_cast<std::size_t>(i), sums.block.data());
  for (std::size_t k = 0; k < sums.all.size(); ++k) sums.all[k] += static_cast<double>(sums.block[k]);
}

// A portion of the sample, and the surface points nearest to it.
class Portion {
 public:
  // In three steps, as a NearestQuery asks.
  void begin(std::span<const OrientedPoint> points, const PartModel& model, const FastMotion& into_part) {
    PointBlock measured;
    count_ = measured.load(points);
    move_points(measured, into_part, count_, at_);
    query_.begin(model, at_, count_);
  }
  void go_on(const PartModel& model) { query_.go_on(model, count_); }
  void finish(const PartModel& model, const Rule& rule, Sums& sums) {
    PointBlock nearest;
    query_.finish(model, at_, count_, nearest);
    add_block(at_, nearest, rule, count_, sums);
  }

 private:
  PointBlock at_;  // part frame
  NearestQuery query_;
  int count_ = 0;
};

void add_surface(NormalEquations& system, std::span<const OrientedPoint> sample, const PartModel& model,
                 const FastMotion& into_part, const Stage& stage) {
  const Vec3f centre = model.centre_mm.cast<float>();
  // The nearest of sampled points lies up to about `aside` beside the foot on the surface. Points without a normal, as
  // those that fill up a block, face nothing.
  const Rule rule{static_cast<float>(stage.radius_mm * stage.radius_mm),
                  std::max(stage.facing, 1e-3F),
                  0.75F * model.spacing_mm,
                  stage.beyond,
                  {centre.x(), centre.y(), centre.z()}};
  Sums sums;
  // While one portion is added up, the memory fetches what the next two ask for.
  std::array<Portion, 3> under_way;
  const std::size_t portions = PointBlock::blocks_for(sample.size());
  for (std::size_t step = 0; step < portions + 2; ++step) {
    if (step < portions) under_way[step % 3].begin(sample.subspan(step * PointBlock::kSize), model, into_part);
    if (step >= 1 && step - 1 < portions) under_way[(step - 1) % 3].go_on(model);
    if (step >= 2) under_way[(step - 2) % 3].finish(model, rule, sums);
  }
  int at_sum = Sums::kInformation;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) system.information(i, j) = sums.of(at_sum++);
    system.gradient[i] = sums.of(Sums::kGradient + i);
  }
  system.weight = sums.of(Sums::kWeight);
  system.weighted_square = sums.of(Sums::kSquare);
  system.inliers = static_cast<int>(sums.of(Sums::kInliers));
}

void add_outline(NormalEquations& system, std::span<const OutlinePair> outline, const PartModel& model,
                 const FastMotion& into_part, const Stage& stage, double outline_weight) {
  const Vec3f centre = model.centre_mm.cast<float>();
  // Outlines are found less exactly than surfaces.
  const float radius = 1.5F * static_cast<float>(stage.radius_mm);
  for (const OutlinePair& pair : outline) {
    const Vec3f at = into_part * pair.measured_mm;
    const float residual = pair.outward.dot(at - pair.on_part_mm);
    const double weight = outline_weight * tukey_weight(residual * residual, radius * radius);
    if (weight <= 0.0) continue;
    add_row(system, (at - centre).cast<double>(), pair.outward.cast<double>(), residual, weight);
  }
}

}  // namespace

NormalEquations linearise(std::span<const OrientedPoint> sample, const PartModel& model, const PartPose& T_camera_part,
                          const Stage& stage, std::span<const OutlinePair> outline, double outline_weight) {
  const FastMotion into_part(T_camera_part.inverse());
  NormalEquations system;
  add_surface(system, sample, model, into_part, stage);
  add_outline(system, outline, model, into_part, stage, outline_weight);
  system.information.triangularView<Eigen::StrictlyUpper>() = system.information.transpose();
  return system;
}

}  // namespace beltpick::icp
