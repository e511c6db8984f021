// Which grasp is offered: parts side by side, on the belt, upside down.
#include <catch2/catch.hpp>
#include <string>

#include "base/units.hpp"
#include "contract/pose_difference.hpp"
#include "contract/result_codes.hpp"
#include "result/grasp_choice.hpp"
#include "support/scenes/models.hpp"
#include "support/scenes/scenes.hpp"

using namespace beltpick;
using namespace beltpick::test;
using result::Reach;

namespace {

// Down into the part along -z, closing along `closing`, the tips at `height_mm`.
GraspPose from_above(const Vec3& closing, double opening_mm, double height_mm = 5.0) {
  GraspPose grasp;
  grasp.T_part_gripper.rotation << closing, (-Vec3::UnitZ()).cross(closing), -Vec3::UnitZ();
  grasp.T_part_gripper.translation_mm = {0.0, 0.0, height_mm};
  grasp.opening_mm = opening_mm;
  return grasp;
}

// A block of 80 x 50 x 30 mm, flat on the belt, and others round it.
struct Blocks {
  Shape shape = block();
  LoadedPart loaded{shape};
  PartModel model = loaded.model();
  result::PartPose truth = on_belt(shape, loaded.part, Mat3::Identity(), 0.0, 0.0);
  std::vector<Placed> placed{{&shape, truth}};
  SceneImage image;

  void grasps(std::initializer_list<GraspPose> list) {
    model.grasp_count = 0;
    for (GraspPose grasp : list) {
      grasp.clear_of_part = result::clear_of_part(grasp, model.surface, model.gripper);
      model.grasps[static_cast<std::size_t>(model.grasp_count++)] = grasp;
    }
  }
  void beside(double x_mm, double y_mm) {
    placed.push_back({&shape, on_belt(shape, loaded.part, Mat3::Identity(), x_mm, y_mm)});
  }
  result::Scene look() {
    image = render(placed, {.width = 320, .height = 240, .focal_px = 560.0});
    result::Scene scene;
    scene.range = image.range();
    scene.labels = image.labels();
    scene.lens = image.lens;
    scene.belt = image.belt;
    return scene;
  }
};

const GraspPose kAcross = from_above(Vec3::UnitY(), 58.0);
const GraspPose kAlong = from_above(Vec3::UnitX(), 88.0);

}  // namespace

TEST_CASE("a lone part is gripped by its first grasp", "[grasp]") {
  Blocks blocks;
  blocks.grasps({kAcross, kAlong});
  const auto scene = blocks.look();
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {scene}).index == 0);
}

TEST_CASE("beside a neighbour the grasp that clears it is chosen, between two none", "[grasp]") {
  Blocks blocks;
  blocks.grasps({kAcross, kAlong});
  blocks.beside(0.0, 55.0);  // 5 mm between them: no room for a jaw of 8
  const auto beside_one = blocks.look();
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {beside_one}) == Reach::kObstructed);
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {beside_one}).index == 1);

  blocks.beside(-85.0, 0.0);
  const auto choice = result::choose_grasp(blocks.model, blocks.truth, {blocks.look()});
  CHECK(choice.index == -1);
  CHECK(choice.count(Reach::kObstructed) == 2);
  const Error reason = result::no_grasp_reason(choice, blocks.model.grasp_count);
  CHECK(reason.code == ResultCode::kObstructed);
  CHECK(std::string(reason.detail).find("2 what lies beside it") != std::string::npos);
}

TEST_CASE("room for the jaw and its clearance is room enough", "[grasp]") {
  Blocks blocks;
  blocks.grasps({kAcross});
  blocks.beside(0.0, 50.0 + 16.0);  // the jaw takes 4 to 12 mm of the gap
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {blocks.look()}).index == 0);
}

TEST_CASE("a grasp that would drive the jaws into the belt is not offered", "[grasp]") {
  Blocks blocks;
  const GraspPose deep = from_above(Vec3::UnitY(), 58.0, -13.0);  // tips 16 mm below the middle of 30
  blocks.grasps({deep, kAlong});
  const auto scene = blocks.look();
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {scene}) == Reach::kMeetsBelt);
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {scene}).index == 1);
  blocks.grasps({deep});
  const auto choice = result::choose_grasp(blocks.model, blocks.truth, {scene});
  CHECK(choice.index == -1);
  CHECK(result::no_grasp_reason(choice, 1).code == ResultCode::kNoGrasp);
}

TEST_CASE("the palm must have room, too", "[grasp]") {
  const Shape wall = bracket();  // stands 55 mm high at one end
  const LoadedPart loaded(wall);
  Blocks blocks;
  blocks.grasps({kAcross});
  // The wall stands beside the block's end, clear of the jaws at its middle, under the palm's edge.
  blocks.placed.push_back({&wall, on_belt(wall, loaded.part, Mat3::Identity(), 98.0, 0.0)});
  const auto scene = blocks.look();
  blocks.model.gripper.palm_width_mm = 110.0;
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {scene}).index == 0);
  blocks.model.gripper.jaw_depth_mm = 30.0;
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {scene}) == Reach::kObstructed);
  blocks.model.gripper.palm_length_mm = 0.0;
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {scene}).index == 0);
}

TEST_CASE("the side of a located part that the camera does not see stands in the way", "[grasp]") {
  Blocks blocks;
  blocks.grasps({kAcross});
  const auto scene = blocks.look();  // the neighbour was not measured at all
  const result::PartPose at = on_belt(blocks.shape, blocks.loaded.part, Mat3::Identity(), 0.0, 55.0);
  const std::array<result::Neighbour, 1> neighbours{result::Neighbour{&blocks.model, at}};
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {scene, neighbours}) == Reach::kNeighbour);
  const std::array<result::Neighbour, 1> away{
      result::Neighbour{&blocks.model, on_belt(blocks.shape, blocks.loaded.part, Mat3::Identity(), 0.0, 120.0)}};
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {scene, away}) == Reach::kReachable);
}

TEST_CASE("a grasp from below is taken where the symmetry brings it up", "[grasp]") {
  Blocks blocks;
  const Mat3 over = Eigen::AngleAxisd(kPi, Vec3::UnitX()).toRotationMatrix();
  GraspPose below = kAcross;
  below.T_part_gripper = Pose<frame::Part, frame::Part>{over, Vec3::Zero()} * kAcross.T_part_gripper;
  blocks.grasps({below});
  const auto scene = blocks.look();
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {scene}) == Reach::kFromBelow);
  const auto choice = result::choose_grasp(blocks.model, blocks.truth, {scene});
  CHECK(choice.index == 0);
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], choice.T_camera_part, {scene}) == Reach::kReachable);
  const PoseDifference same = difference_modulo_symmetry(choice.T_camera_part, blocks.truth, blocks.model);
  CHECK(same.translation_mm < 1e-6);
  CHECK(same.rotation_rad < 1e-6);

  blocks.model.symmetry_count = 0;
  const auto none = result::choose_grasp(blocks.model, blocks.truth, {scene});
  CHECK(none.index == -1);
  CHECK(result::no_grasp_reason(none, 1).code == ResultCode::kNoGrasp);
}

TEST_CASE("a grasp that failed here is not chosen again; turned about, it is another one", "[grasp]") {
  Blocks blocks;
  GraspPose turned = kAcross;
  turned.T_part_gripper.rotation.col(0) *= -1.0;
  turned.T_part_gripper.rotation.col(1) *= -1.0;
  blocks.grasps({kAcross, turned});
  blocks.model.symmetry_count = 0;
  const auto scene = blocks.look();
  const std::array<result::GripperPose, 1> failed{blocks.truth * kAcross.T_part_gripper};
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {scene, {}, failed}).index == 1);
  blocks.model.grasp_count = 1;
  CHECK(result::choose_grasp(blocks.model, blocks.truth, {scene, {}, failed}).index == -1);
}

TEST_CASE("open jaws that meet the part itself are told when it is loaded", "[grasp]") {
  Blocks blocks;
  CHECK(result::clear_of_part(kAcross, blocks.model.surface, {}));
  CHECK_FALSE(result::clear_of_part(from_above(Vec3::UnitY(), 40.0), blocks.model.surface, {}));
  GripperShape stubby;
  stubby.jaw_depth_mm = 8.0;
  CHECK_FALSE(result::clear_of_part(kAcross, blocks.model.surface, stubby));
  blocks.grasps({from_above(Vec3::UnitY(), 40.0)});
  const auto scene = blocks.look();
  CHECK(result::reach(blocks.model, blocks.model.grasps[0], blocks.truth, {scene}) == Reach::kMeetsPart);
}
