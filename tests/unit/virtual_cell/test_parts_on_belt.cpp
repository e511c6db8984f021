// The judge of picks: pose against truth, and the gripper's way in.
#include <catch2/catch.hpp>

#include "base/units.hpp"
#include "virtual_cell/world/parts_on_belt.hpp"

using namespace beltpick;
using namespace beltpick::virtual_cell;

namespace {

// Two knuckles, far from each other, as they fall from the maker of scenes is too much here: they float, which the
// judge does not mind.
struct Fixture {
  std::vector<ScenePart> parts{*builtin_part("knuckle"), *builtin_part("elbow")};
  Rig rig = *make_rig();
  PartsOnBelt belt{parts, rig};
  Pose<frame::Belt, frame::Part> lying;

  Fixture() {
    lying.translation_mm = {20.0, 10.0, 60.0};
    lying.rotation = Eigen::AngleAxisd(0.4, Vec3::UnitZ()).toRotationMatrix();
  }

  static Offer offer(const Pose<frame::Belt, frame::Part>& part, const Grasp& grasp, std::uint16_t number) {
    Offer offer;
    offer.whole = true;
    offer.part_number = number;
    offer.frame = OfferFrame::kBelt;
    offer.part_pose = part.matrix();
    offer.gripper_pose = (part * grasp.T_part_gripper).matrix();
    offer.opening_mm = grasp.opening_mm;
    return offer;
  }
};

Pose<frame::Belt, frame::Part> moved(Pose<frame::Belt, frame::Part> pose, double mm) {
  pose.translation_mm.x() += mm;
  return pose;
}

}  // namespace

TEST_CASE("a right pose is picked, one off by more than a millimetre or a degree crashes") {
  Fixture f;
  f.belt.set({{0, f.lying}});
  const Grasp& grasp = f.parts[0].grasps.front();
  CHECK(f.belt.judge(Fixture::offer(f.lying, grasp, 1)).outcome == PickOutcome::kPicked);
  CHECK(f.belt.judge(Fixture::offer(moved(f.lying, 0.8), grasp, 1)).outcome == PickOutcome::kPicked);
  CHECK(f.belt.judge(Fixture::offer(moved(f.lying, 1.2), grasp, 1)).outcome == PickOutcome::kCrashed);
  auto turned = f.lying;
  const Vec3 centre = turned * f.parts[0].centre_of_mass_mm;
  turned.rotation = Eigen::AngleAxisd(rad_from_deg(1.3), Vec3::UnitZ()).toRotationMatrix() * turned.rotation;
  turned.translation_mm = centre - turned.rotation * f.parts[0].centre_of_mass_mm;
  const PickJudgement judged = f.belt.judge(Fixture::offer(turned, grasp, 1));
  CHECK(judged.outcome == PickOutcome::kCrashed);
  CHECK(judged.angle_deg == Approx(1.3).margin(0.01));
  CHECK(judged.position_mm < 0.01);
  CHECK(f.belt.judge(Fixture::offer(f.lying, grasp, 2)).outcome == PickOutcome::kCrashed);
}

TEST_CASE("a pose in another frame means the same, and a symmetric turn is as good") {
  Fixture f;
  f.belt.set({{1, f.lying}});
  const Grasp& grasp = f.parts[1].grasps.front();
  const auto half_turn = f.lying * f.parts[1].symmetries.front();
  // Turned over, the grasp from below is the one from above.
  CHECK(f.belt.judge(Fixture::offer(half_turn, f.parts[1].grasps[1], 2)).outcome == PickOutcome::kPicked);
  Offer in_camera = Fixture::offer(f.lying, grasp, 2);
  in_camera.frame = OfferFrame::kCamera;
  in_camera.part_pose = f.rig.T_camera_belt.matrix() * in_camera.part_pose;
  in_camera.gripper_pose = f.rig.T_camera_belt.matrix() * in_camera.gripper_pose;
  CHECK(f.belt.judge(in_camera).outcome == PickOutcome::kPicked);
}

TEST_CASE("a neighbour in the gripper's way blocks the pick") {
  Fixture f;
  const Grasp& grasp = f.parts[0].grasps.front();
  auto above = f.lying;
  above.translation_mm += Vec3(0.0, 25.0, 70.0);  // over one of the jaws, not touching
  f.belt.set({{0, f.lying}, {0, above}});
  const PickJudgement judged = f.belt.judge(Fixture::offer(f.lying, grasp, 1));
  CHECK(judged.index == 0);
  CHECK(judged.outcome == PickOutcome::kBlocked);
  f.belt.remove(1);
  CHECK(f.belt.parts().size() == 1);
  CHECK(f.belt.judge(Fixture::offer(f.lying, grasp, 1)).outcome == PickOutcome::kPicked);
}
