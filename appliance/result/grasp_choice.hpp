// Which taught grasp can be reached: the gripper on its way in must be clear of the belt, of everything measured, and
// of the sides of located parts that the camera does not see.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/result.hpp"
#include "contract/gripper.hpp"
#include "contract/part_model.hpp"
#include "result/drawing.hpp"
#include "result/scene.hpp"

namespace beltpick::result {

using GripperPose = Pose<frame::Camera, frame::Gripper>;

// Why a grasp is not chosen, or that it can be.
enum class Reach : std::uint8_t {
  kReachable,
  kFromBelow,   // its way in is more than 60 degrees off the belt's normal (the line of sight where there is no belt)
  kMeetsBelt,   // jaws or palm would
  kMeetsPart,   // the open jaws or the palm meet the part that is to be gripped
  kObstructed,  // something measured stands in the way
  kNeighbour,   // the hidden side of a located part does
  kRefused      // a pick with it failed here before
};
inline constexpr std::size_t kReachCount = 7;

// Another located part: its whole surface is known.
struct Neighbour {
  const PartModel* model = nullptr;
  PartPose T_camera_part;
};

// What a grasp is to be clear of.
struct Surroundings {
  const Scene& scene;
  std::span<const Neighbour> neighbours{};
  std::span<const GripperPose> refused{};  // with which a pick at this place failed already
};

// The part's gripper at one of its grasps, in this pose.
Reach reach(const PartModel& model, const GraspPose& grasp, const PartPose& T_camera_part, const Surroundings& around);

// Whether the open gripper, in place, is clear of the part itself. A property of the part: asked once, when it is
// loaded.
bool clear_of_part(const GraspPose& grasp, std::span<const OrientedPoint> surface, const GripperShape& gripper);

struct GraspChoice {
  int index = -1;                           // into model.grasps; -1: none can be reached
  PartPose T_camera_part;                   // to which it belongs
  std::array<int, kReachCount> findings{};  // of the pose asked for: grasps by Reach, up to the chosen one

  [[nodiscard]] int count(Reach reach) const { return findings[static_cast<std::size_t>(reach)]; }
};

// The first grasp that can be reached: that of the pose, or else of a pose that the part's symmetry makes the same.
GraspChoice choose_grasp(const PartModel& model, const PartPose& T_camera_part, const Surroundings& around);

// Why nothing was chosen, in words: kObstructed where a grasp will come free when a neighbour is gone, else kNoGrasp.
Error no_grasp_reason(const GraspChoice& choice, int grasp_count);

}  // namespace beltpick::result
