#include "virtual_cell/world/parts_on_belt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/units.hpp"
#include "virtual_cell/world/gripper_path.hpp"

namespace beltpick::virtual_cell {
namespace {

constexpr double kJawTouch_mm = 0.5;  // jaws of the real gripper yield this much before it counts as a collision

using BeltPose = Pose<frame::Belt, frame::Part>;

// Poses of the register table to the belt frame.
template <class From>
Pose<frame::Belt, From> to_belt(const Rig& rig, OfferFrame frame, const Mat4& pose) {
  switch (frame) {
    case OfferFrame::kBelt:
      return Pose<frame::Belt, From>::from_matrix(pose);
    case OfferFrame::kRobot:
      return rig.T_robot_belt.inverse() * Pose<frame::Robot, From>::from_matrix(pose);
    case OfferFrame::kCamera:
      break;
  }
  return rig.T_camera_belt.inverse() * Pose<frame::Camera, From>::from_matrix(pose);
}

}  // namespace

PartsOnBelt::PartsOnBelt(std::span<const ScenePart> parts, const Rig& rig)
    : parts_(parts), settler_(parts), rig_(rig) {}

void PartsOnBelt::shift(double along_mm) {
  for (BeltPart& part : scene_) part.T_belt_part.translation_mm.x() += along_mm;
}

std::vector<PartInstance> PartsOnBelt::instances() const {
  std::vector<PartInstance> instances;
  instances.reserve(scene_.size());
  for (const BeltPart& part : scene_) instances.push_back({part.part, rig_.T_camera_belt * part.T_belt_part});
  return instances;
}

BeltPose PartsOnBelt::part_in_belt(const Offer& offer) const {
  return to_belt<frame::Part>(rig_, offer.frame, offer.part_pose);
}

Pose<frame::Belt, frame::Gripper> PartsOnBelt::gripper_in_belt(const Offer& offer) const {
  return to_belt<frame::Gripper>(rig_, offer.frame, offer.gripper_pose);
}

PickJudgement PartsOnBelt::judge(const Offer& offer) const {
  PickJudgement best;
  best.position_mm = best.angle_deg = std::numeric_limits<double>::infinity();
  const BeltPose offered = part_in_belt(offer);
  for (std::size_t i = 0; i < scene_.size(); ++i) {
    if (scene_[i].part + 1 != offer.part_number) continue;
    const ScenePart& part = parts_[static_cast<std::size_t>(scene_[i].part)];
    std::vector<Pose<frame::Part, frame::Part>> turns = part.symmetries;
    turns.emplace_back();
    for (const auto& turn : turns) {
      const BeltPose truth = scene_[i].T_belt_part * turn;
      const double position = (offered * part.centre_of_mass_mm - truth * part.centre_of_mass_mm).norm();
      const double angle = deg_from_rad(rotation_between_rad(offered.rotation, truth.rotation));
      // Ranked in units of the limits, so that a symmetric part is held against the turn that it was found in.
      const auto rank = [this](double mm, double deg) {
        return std::max(mm / limits_.position_mm, deg / limits_.angle_deg);
      };
      if (rank(position, angle) >= rank(best.position_mm, best.angle_deg)) continue;
      best.index = static_cast<int>(i);
      best.position_mm = position;
      best.angle_deg = angle;
    }
  }
  if (best.index < 0 || best.position_mm > limits_.position_mm || best.angle_deg > limits_.angle_deg) return best;
  const char* obstacle = in_the_way(offer, best.index);
  best.outcome = obstacle == nullptr ? PickOutcome::kPicked : PickOutcome::kBlocked;
  if (obstacle != nullptr) best.in_the_way = obstacle;
  return best;
}

const char* PartsOnBelt::in_the_way(const Offer& offer, int index) const {
  const auto T_belt_gripper = gripper_in_belt(offer);
  for (const int side : {-1, 1}) {
    JawSweep sweep = jaw_sweep(gripper_, offer.opening_mm, side);
    sweep.min().array() += kJawTouch_mm;
    sweep.max().array() -= kJawTouch_mm;
    if (sweep_meets_belt(sweep, T_belt_gripper)) return "belt";
    for (std::size_t i = 0; i < scene_.size(); ++i) {
      const auto T_gripper_part = T_belt_gripper.inverse() * scene_[i].T_belt_part;
      if (!sweep_meets_mesh(sweep, parts_[static_cast<std::size_t>(scene_[i].part)].mesh, T_gripper_part)) continue;
      return static_cast<int>(i) == index ? "part itself" : "other part";
    }
  }
  return nullptr;
}

void PartsOnBelt::remove(int index) {
  const bool touched = settler_.touch(scene_, static_cast<std::size_t>(index));
  scene_.erase(scene_.begin() + index);
  if (!touched || scene_.empty()) return;
  Scene settled = scene_;
  // Parts that do not come to rest stay where they were: the next view of them is as good as any.
  if (settler_.settle(settled)) scene_ = std::move(settled);
}

}  // namespace beltpick::virtual_cell
