// The covariance that locate tells against how much poses of the same scene really differ from noise to noise.
#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include <Eigen/Eigenvalues>

#include "contract/freedoms.hpp"
#include "pipeline/locate.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr int kSeeds = 16;

// The small motion, camera frame, about the box's centre, that takes `from` to `to`.
Vec6 motion(const result::PartPose& from, const result::PartPose& to, const Vec3& centre_mm) {
  const Eigen::AngleAxisd turn(Mat3(to.rotation * from.rotation.transpose()));
  Vec6 m;
  m << turn.angle() * turn.axis(), to * centre_mm - from * centre_mm;
  return m;
}

struct Spread {
  std::vector<Vec6> motions;
  Mat6 told = Mat6::Zero();  // mean of the covariances

  // Variance of the motions along a direction, their mean taken out.
  [[nodiscard]] double variance(const Vec6& direction) const {
    double sum = 0.0, square = 0.0;
    for (const Vec6& m : motions) {
      sum += direction.dot(m);
      square += direction.dot(m) * direction.dot(m);
    }
    const auto n = static_cast<double>(motions.size());
    return (square - sum * sum / n) / (n - 1.0);
  }
};

Spread spread_of(const Shape& shape, const LoadedPart& loaded) {
  Spread spread;
  InArena<pipeline::Locator> locator(test_limits(), 1);
  const auto truth = on_belt(shape, loaded.part, Mat3::Identity(), 10.0, 5.0);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    SceneImage image = render({{&shape, truth}}, {.width = 480,
                                                  .height = 360,
                                                  .focal_px = 840.0,
                                                  .noise_mm = 0.15,
                                                  .shadows = false,
                                                  .seed = static_cast<std::uint64_t>(seed)});
    const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
    REQUIRE(found.parts.size() == 1);
    spread.motions.push_back(motion(truth, found.parts[0].T_camera_part, loaded.model().centre_mm));
    spread.told += found.parts[0].covariance / kSeeds;
  }
  return spread;
}

}  // namespace

TEST_CASE("poses spread over noise as their covariance tells", "[covariance]") {
  const Shape shape = bracket();
  const LoadedPart loaded(shape);
  const Spread spread = spread_of(shape, loaded);
  // Along each of the six motions that vary independently, lengths on the rim.
  Vec6 rim = Vec6::Ones();
  rim.head<3>().setConstant(0.5 * loaded.model().diagonal_mm);
  const Eigen::SelfAdjointEigenSolver<Mat6> motions(Mat6(rim.asDiagonal() * spread.told * rim.asDiagonal()));
  for (int i = 0; i < 6; ++i) {
    const Vec6 direction = rim.cwiseProduct(Vec6(motions.eigenvectors().col(i)));
    const double ratio = std::sqrt(spread.variance(direction) / motions.eigenvalues()[i]);
    INFO("motion " << i << ": told " << std::sqrt(motions.eigenvalues()[i]) << " mm on the rim, real/told " << ratio);
    // 16 noises tell a deviation to about a fifth; neighbouring points of the template err together.
    CHECK(ratio > 0.3);
    CHECK(ratio < 3.0);
  }
}

TEST_CASE("a pin's turn about its axis is told to be free, and the rest of it is held", "[covariance]") {
  const Shape shape = pin();
  const LoadedPart loaded(shape);
  InArena<pipeline::Locator> locator(test_limits(), 1);
  const Mat3 lying = Eigen::AngleAxisd(1.5707963, Vec3::UnitY()).toRotationMatrix();
  SceneImage image = render({{&shape, on_belt(shape, loaded.part, lying, 0.0, 0.0)}});
  const auto found = locator.made.locate(input_of(image), loaded.store.made.models());
  REQUIRE(found.parts.size() == 1);
  const auto freedoms = freedoms_of(found.parts[0].covariance, found.parts[0].T_camera_part, loaded.part);
  const auto words = unobservable(freedoms, loaded.part.symmetry);
  REQUIRE(words.size() == 2);
  CHECK(words[0] == "turn about the part's axis of symmetry");
  CHECK(words[1] == "which end of its axis is which (it looks the same turned over)");
  CHECK(std::count_if(freedoms.begin(), freedoms.end(), [](const Freedom& f) { return f.observable; }) == 5);
}
