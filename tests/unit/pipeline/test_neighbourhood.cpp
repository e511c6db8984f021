// Where within a heap of parts the search begins, and which of its points go together.
#include "pipeline/neighbourhood.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "base/random.hpp"

using namespace beltpick;

namespace {

std::vector<OrientedPoint> cloud(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<OrientedPoint> points(count);
  for (OrientedPoint& point : points) {
    point.point_mm = Vec3f(static_cast<float>(random.uniform(-60, 60)), static_cast<float>(random.uniform(-40, 40)),
                           static_cast<float>(random.uniform(620, 700)));
  }
  return points;
}

}  // namespace

TEST_CASE("the highest point is measured from a tilted belt, not along the camera's axis", "[neighbourhood]") {
  std::vector<OrientedPoint> sample(2);
  sample[0].point_mm = Vec3f(100, 0, 690);
  sample[1].point_mm = Vec3f(-100, 0, 695);
  CHECK(pipeline::highest_point_mm(sample, std::nullopt) == sample[0].point_mm);
  const Vec3 normal = Vec3(-0.1, 0, -1).normalized();  // this belt rises towards +x
  const Plane belt{normal, normal.dot(Vec3(0, 0, 700))};
  CHECK(pipeline::highest_point_mm(sample, belt) == sample[1].point_mm);
}

TEST_CASE("a neighbourhood is all that lies within the radius, and nothing is lost", "[neighbourhood]") {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const std::vector<OrientedPoint> before = cloud(500, seed);
    std::vector<OrientedPoint> sample = before;
    const Vec3f centre_mm = before[7].point_mm;
    const pipeline::Neighbourhood found = pipeline::gather_round(sample, centre_mm, 35.0F);
    float farthest_mm = 0.0F;
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const float distance_mm = (sample[i].point_mm - centre_mm).norm();
      CHECK((distance_mm < 35.0F) == (i < found.count));
      farthest_mm = std::max(farthest_mm, distance_mm);
      CHECK(std::any_of(before.begin(), before.end(), [&](const auto& p) { return p.point_mm == sample[i].point_mm; }));
    }
    CHECK(found.count > 1);
    CHECK(found.count < sample.size());
    CHECK((found.farthest_mm - centre_mm).norm() == farthest_mm);
  }
}
