// Alignment: its basin, its accuracy, what it says of freedoms that nothing determines.
#include <Eigen/Eigenvalues>
#include <array>
#include <catch2/catch.hpp>

#include "base/random.hpp"
#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "icp/align.hpp"
#include "plain_normal_equations.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

std::vector<OrientedPoint> noisy_sample(const PartModel& model, const icp::PartPose& truth, std::size_t count) {
  std::vector<OrientedPoint> sample;
  Random random(8);
  while (sample.size() < count) {
    const OrientedPoint& point = model.surface[random.below(static_cast<std::uint32_t>(model.surface.size()))];
    const Vec3 at = truth * point.point_mm.cast<double>();
    const Vec3 normal = truth.rotation * point.normal.cast<double>();
    if (normal.dot(at) > 0.0) continue;
    const Vec3 noisy = at + at.normalized() * random.uniform(-0.08, 0.08);
    sample.push_back({noisy.cast<float>(), normal.cast<float>()});
  }
  return sample;
}

icp::PartPose pushed(const icp::PartPose& truth, const Vec3& centre, const Vec3& shift, const Vec3& axis,
                     double angle) {
  const Mat3 turn = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return {turn * truth.rotation, truth * centre + shift - turn * truth.rotation * centre};
}

const std::array<icp::Stage, 3> kStages{icp::Stage{16.0, 15, 0.3F, 0.3F}, icp::Stage{5.0, 15, 0.5F, 0.1F},
                                        icp::Stage{1.0, 15, 0.8F}};

}  // namespace

TEST_CASE("from half a search step away, alignment ends at the true pose") {
  const LoadedPart loaded(knuckle());
  const PartModel& model = loaded.model();
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const icp::PartPose truth{any_rotation(seed), {10.0, 5.0, 700.0}};
    const auto sample = noisy_sample(model, truth, 1000);
    Random random(seed);
    const Vec3 axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const auto start = pushed(truth, model.centre_mm, {3.0, -2.5, 3.0}, axis, rad_from_deg(7.5));
    const Alignment found = icp::align(sample, model, start, kStages, icp::Noise{});
    const PoseDifference d = difference_modulo_symmetry(found.T_camera_part, truth, model);
    INFO("seed " << seed);
    CHECK(d.translation_mm < 0.05);
    CHECK(deg_from_rad(d.rotation_rad) < 0.05);
    CHECK(found.inlier_share > 0.9);
    CHECK(found.rms_mm < 0.08);
  }
}

TEST_CASE("an approach ends where an alignment without an outline ends, and leaves out its covariance") {
  const LoadedPart loaded(knuckle());
  const PartModel& model = loaded.model();
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const icp::PartPose truth{any_rotation(seed), {10.0, 5.0, 700.0}};
    const auto sample = noisy_sample(model, truth, 500);
    const auto start = pushed(truth, model.centre_mm, {3.0, -2.5, 3.0}, {1.0, -2.0, 0.5}, rad_from_deg(7.5));
    const Alignment whole = icp::align(sample, model, start, kStages, icp::Noise{});
    const Alignment quick = icp::approach(sample, model, start, kStages);
    CHECK(quick.T_camera_part.rotation == whole.T_camera_part.rotation);
    CHECK(quick.T_camera_part.translation_mm == whole.T_camera_part.translation_mm);
    CHECK(quick.iterations == whole.iterations);
    CHECK(quick.inlier_share == Approx(whole.inlier_share).margin(0.01));  // of the last step but one
  }
}

TEST_CASE("the kernel's normal equations are those of the plain loop, with either index and any number of points") {
  const LoadedPart loaded(knuckle());
  PartModel model = loaded.model();
  const ClosestPointTree tree(model.surface);
  const icp::PartPose truth{any_rotation(2), {10.0, 5.0, 700.0}};
  const auto sample = noisy_sample(model, truth, 333);
  const auto pose = pushed(truth, model.centre_mm, {2.0, -1.5, 1.0}, {1.0, 2.0, 3.0}, rad_from_deg(3.0));
  for (const icp::Stage& stage : kStages) {
    for (const std::size_t count : {1U, 16U, 63U, 64U, 65U, 333U}) {
      for (const ClosestPointTree* index : {static_cast<const ClosestPointTree*>(nullptr), &tree}) {
        model.tree = index;
        const auto some = std::span(sample).first(count);
        const auto fast = icp::linearise(some, model, pose, stage, {}, 0.0);
        const auto plain = plain_normal_equations(some, model, pose, stage);
        INFO("radius " << stage.radius_mm << ", " << count << " points");
        // A point on the rim of a cell or of the tolerances may fall to either side.
        CHECK(std::abs(fast.inliers - plain.inliers) <= 1);
        const double scale = std::max(1.0, plain.information.norm());
        CHECK((fast.information - plain.information).norm() < 2e-3 * scale);
        CHECK((fast.gradient - plain.gradient).norm() < 2e-3 * std::max(1.0, plain.gradient.norm()));
        CHECK(fast.weighted_square == Approx(plain.weighted_square).epsilon(2e-3).margin(1e-3));
      }
    }
  }
}

TEST_CASE("the k-d tree as back-end leads to the same pose") {
  LoadedPart loaded(bracket());
  PartModel model = loaded.model();
  const icp::PartPose truth{any_rotation(3), {10.0, 5.0, 700.0}};
  const auto sample = noisy_sample(model, truth, 1000);
  const auto start = pushed(truth, model.centre_mm, {2, 1, -2}, Vec3::UnitX(), 0.05);
  const Alignment by_grid = icp::align(sample, model, start, kStages, icp::Noise{});
  const ClosestPointTree tree(model.surface);
  model.tree = &tree;
  const Alignment by_tree = icp::align(sample, model, start, kStages, icp::Noise{});
  const PoseDifference d = difference_modulo_symmetry(by_grid.T_camera_part, by_tree.T_camera_part, model);
  CHECK(d.translation_mm < 0.03);
  CHECK(deg_from_rad(d.rotation_rad) < 0.03);
}

TEST_CASE("a turn that the shape leaves free stays where it was and is told as uncertain") {
  const LoadedPart loaded(pin());
  const icp::PartPose truth{any_rotation(5), {0.0, 0.0, 700.0}};
  const auto sample = noisy_sample(loaded.model(), truth, 1000);
  const auto start = pushed(truth, loaded.model().centre_mm, {1, 1, 1}, truth.rotation.col(2), 0.3);
  const Alignment found = icp::align(sample, loaded.model(), start, kStages, icp::Noise{});
  CHECK(difference_modulo_symmetry(found.T_camera_part, truth, loaded.model()).translation_mm < 0.05);
  const Vec3 axis = truth.rotation.col(2);
  const double about_axis = axis.dot(found.covariance.topLeftCorner<3, 3>() * axis);
  const Vec3 across = axis.unitOrthogonal();
  const double about_other = across.dot(found.covariance.topLeftCorner<3, 3>() * across);
  CHECK(about_axis > 100.0 * about_other);
}

TEST_CASE("the covariance covers the errors that noise makes") {
  const LoadedPart loaded(bracket());
  const icp::PartPose truth{any_rotation(9), {0.0, 0.0, 700.0}};
  const auto sample = noisy_sample(loaded.model(), truth, 500);
  const Alignment found = icp::align(sample, loaded.model(), truth, kStages, icp::Noise{});
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(found.covariance);
  CHECK(solver.eigenvalues().minCoeff() > 0.0);
  const Vec3 error = found.T_camera_part * loaded.model().centre_mm - truth * loaded.model().centre_mm;
  for (int axis = 0; axis < 3; ++axis)
    CHECK(std::abs(error[axis]) < 6.0 * std::sqrt(found.covariance(3 + axis, 3 + axis)));
}

TEST_CASE("nothing near: the pose stays and no inlier is claimed") {
  const LoadedPart loaded(bracket());
  const icp::PartPose far{Mat3::Identity(), {500.0, 0.0, 700.0}};
  const std::vector<OrientedPoint> sample(100, OrientedPoint{Vec3f(0, 0, 700), -Vec3f::UnitZ()});
  const Alignment found = icp::align(sample, loaded.model(), far, kStages, icp::Noise{});
  CHECK(found.inlier_share == 0.0);
  CHECK((found.T_camera_part.translation_mm - far.translation_mm).norm() == 0.0);
}
