// Plant: what the virtual PLC's program drives: belt, robot and the faults that are done to the cell. The live world is
// one; a test's stand-in is another.
#pragma once

#include <string>

#include "virtual_cell/world/fault_plan.hpp"
#include "virtual_cell/world/plc_link.hpp"

namespace beltpick::virtual_cell {

enum class PickOutcome {
  kPicked,
  kCrashed,  // the pose was worse than the limits: a real robot would have hit something
  kBlocked,  // the pose was right, the gripper's way in was not free
};

struct PickResult {
  PickOutcome outcome = PickOutcome::kCrashed;
  double position_mm = 0.0;  // error of the offered pose against the nearest part of that kind
  double angle_deg = 0.0;
  const char* in_the_way = "";  // of a blocked pick: "belt", "part itself", "other part"
};

class Plant {
 public:
  virtual ~Plant() = default;

  // Runs the belt until the next parts lie in view; false when the belt is empty. The belt stands before and after.
  virtual bool bring_next_parts() = 0;
  // The hard-wired lines.
  virtual void set_belt_stopped_line(bool stopped) = 0;
  virtual void set_emergency_stop_line(bool pressed) = 0;

  // The robot goes in, grips where the offer says, and leaves with the part where it succeeded. The scene has settled
  // when it returns.
  virtual PickResult pick(const Offer& offer) = 0;
  // The robot goes in, grips nothing and leaves.
  virtual void miss() = 0;
  [[nodiscard]] virtual int parts_in_view() const = 0;

  // Camera exposures since the start of the world.
  [[nodiscard]] virtual int exposures() const = 0;
  // Does a fault of camera, network, trigger board or wire to the cell; the PLC's own faults are not its business. From
  // any thread.
  virtual void break_device(CellFault fault) = 0;
  virtual void mend_devices() = 0;
};

}  // namespace beltpick::virtual_cell
