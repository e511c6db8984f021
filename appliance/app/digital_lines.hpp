// The hard-wired inputs of the cell, wherever they are wired to: the trigger microcontroller, or GPIO of the PC.
#pragma once

namespace beltpick::app {

struct LineLevels {
  bool known = false;  // false: the device that reads them does not answer; the levels are then the safe ones
  bool belt_stopped = false;
  bool emergency_stop = true;
};

class DigitalLines {
 public:
  virtual ~DigitalLines() = default;
  // The levels of this moment; never blocks, never allocates.
  virtual LineLevels read() = 0;
};

}  // namespace beltpick::app
