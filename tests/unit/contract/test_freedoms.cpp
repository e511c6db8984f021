// What a covariance and a symmetry say in words.
#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "contract/freedoms.hpp"

using namespace beltpick;

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;

PartTemplate part_of_200_mm() {
  PartTemplate part;
  part.box_min_mm = {-80.0, -60.0, 0.0};
  part.box_max_mm = {80.0, 60.0, 0.0};
  return part;
}

const Mat3 kTurned = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
const Pose<frame::Camera, frame::Part> kPose{kTurned, {10.0, -20.0, 700.0}};

// 2 micrometres and as much on the rim, but for one motion of the part about its box's centre, given in its own frame.
Mat6 loose(const Vec3& turn, const Vec3& slide) {
  Eigen::Matrix<double, 6, 1> motion;
  motion << kTurned * turn, kTurned * slide;
  Mat6 covariance = Mat6::Identity() * 4e-6;
  covariance.topLeftCorner<3, 3>() /= 100.0 * 100.0;
  return covariance + motion * motion.transpose();
}

}  // namespace

TEST_CASE("a pose that is held has six freedoms, all of them observable", "[freedoms]") {
  const auto freedoms = freedoms_of(loose(Vec3::Zero(), Vec3::Zero()), kPose, part_of_200_mm());
  REQUIRE(freedoms.size() == 6);
  for (const Freedom& freedom : freedoms) CHECK(freedom.observable);
  CHECK(unobservable(freedoms, {}).empty());
}

TEST_CASE("what is not held is named in the part's frame, the loosest first", "[freedoms]") {
  const auto sliding = freedoms_of(loose(Vec3::Zero(), {0.0, 0.4, 0.0}), kPose, part_of_200_mm());
  CHECK(sliding[0].words == "slide along the part's y axis");
  CHECK(sliding[0].sigma == Approx(0.4).epsilon(0.01));
  CHECK(unobservable(sliding, {}) == std::vector<std::string>{"slide along the part's y axis"});

  const auto turning = freedoms_of(loose({0.0, 0.0, 0.01}, Vec3::Zero()), kPose, part_of_200_mm());
  CHECK(turning[0].words == "turn about the part's z axis");
  CHECK(turning[0].sigma == Approx(0.01).epsilon(0.01));
  CHECK(turning[0].rim_mm == Approx(1.0).epsilon(0.01));
  CHECK_FALSE(turning[0].observable);
}

TEST_CASE("a turn about an axis beside the centre is told with its place", "[freedoms]") {
  // About z through (40, 0, 0): the centre, 40 mm beside it, moves across.
  const Vec3 turn(0.0, 0.0, 0.01);
  const auto freedoms = freedoms_of(loose(turn, turn.cross(Vec3(-40.0, 0.0, 0.0))), kPose, part_of_200_mm());
  REQUIRE(freedoms[0].turn);
  CHECK((freedoms[0].through_part_mm - Vec3(40.0, 0.0, 0.0)).norm() < 0.5);
  CHECK(freedoms[0].words == "turn about the part's z axis through (40, 0, 0) mm");
}

TEST_CASE("a body of revolution may turn about its axis, and nothing else follows from that", "[freedoms]") {
  PartTemplate part = part_of_200_mm();
  part.symmetry.name = "revolution";
  part.symmetry.revolution = true;
  part.symmetry.axis_direction = Vec3::UnitX();
  part.symmetry.axis_point_mm = {0.0, 30.0, 0.0};  // the centre of its box lies beside it
  Mat6 covariance = loose(Vec3::Zero(), Vec3::Zero());
  add_free_turn(covariance, kPose * part.symmetry.axis_point_mm, kTurned * Vec3::UnitX(), kPose * Vec3::Zero());
  CHECK(std::sqrt(covariance.topLeftCorner<3, 3>().trace()) == Approx(2.0 * kPi / std::sqrt(12.0)).epsilon(1e-4));
  const auto freedoms = freedoms_of(covariance, kPose, part);
  REQUIRE(freedoms.size() == 6);
  CHECK(freedoms[0].by_symmetry);
  CHECK_FALSE(freedoms[0].observable);
  CHECK(unobservable(freedoms, part.symmetry) == std::vector<std::string>{"turn about the part's axis of symmetry"});
}

TEST_CASE("like positions of a symmetric part are told", "[freedoms]") {
  PartTemplate part = part_of_200_mm();
  part.symmetry.name = "C4";
  part.symmetry.elements.resize(3);
  const auto freedoms = freedoms_of(loose(Vec3::Zero(), Vec3::Zero()), kPose, part);
  const auto words = unobservable(freedoms, part.symmetry);
  REQUIRE(words.size() == 1);
  CHECK(words[0] == "which of its 4 like positions it has (symmetry C4)");
  part.symmetry.name = "sphere";
  part.symmetry.elements.clear();
  CHECK(unobservable(freedoms_of(loose(Vec3::Zero(), Vec3::Zero()), kPose, part), part.symmetry) ==
        std::vector<std::string>{"any turn about the part's centre"});
}
