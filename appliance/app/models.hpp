// What the cycle asks of the loaded recipes, templates and calibration. The real one is ModelHub; tests stand in for
// it.
#pragma once

#include <cstdint>

#include "base/pose.hpp"
#include "contract/part_template.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::app {

enum class PoseFrame : std::uint16_t { kCamera = 1, kBelt = 2, kRobot = 3 };  // as register pose_frame tells it

// The frame in which poses are offered: the robot's where the cell file knows it, else the belt's, else the camera's.
struct OfferFrame {
  PoseFrame frame = PoseFrame::kCamera;
  Pose<frame::Robot, frame::Camera> T_offer_camera;  // identity for the camera; typed as the frame it mostly is
};

class Models {
 public:
  virtual ~Models() = default;

  [[nodiscard]] virtual std::uint16_t active_recipe() const = 0;
  [[nodiscard]] virtual bool knows_recipe(std::uint16_t number) const = 0;
  // Why the active recipe cannot be run; kOk when it can.
  [[nodiscard]] virtual ResultCode code() const = 0;
  // What the active recipe's sequence takes, START to the last frame.
  [[nodiscard]] virtual std::int64_t capture_time_us() const = 0;
  // False while a recipe is being loaded: no capture may start.
  [[nodiscard]] virtual bool idle() const = 0;
  // Whether calibration, cell, recipe or templates were swapped from outside since the last call.
  virtual bool take_changed() = 0;
  // Loads another recipe; idle() is false until that is done.
  virtual void select_recipe(std::uint16_t number) = 0;

  [[nodiscard]] virtual OfferFrame offer_frame() const = 0;
  // A grasp of the active recipe's template, or null.
  [[nodiscard]] virtual const Grasp* grasp(int template_index, int grasp_index) const = 0;
};

}  // namespace beltpick::app
