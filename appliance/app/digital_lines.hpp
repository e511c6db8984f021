// The hard-wired lines of the cell, wherever they are wired to: the trigger microcontroller, or GPIO of the PC.
#pragma once

#include "contract/result_codes.hpp"

namespace beltpick::app {

struct LineLevels {
  bool known = false;  // false: the device that reads them does not answer; the levels are then the safe ones
  bool belt_stopped = false;
  bool emergency_stop = true;
  ResultCode unknown_because = ResultCode::kTriggerLost;
};

class DigitalLines {
 public:
  virtual ~DigitalLines() = default;
  // The levels of this moment; never blocks, never allocates.
  virtual LineLevels read() = 0;
  // Drives "belt may move", where it is wired: as the register's bit.
  virtual void permit_belt(bool may_move) = 0;
};

}  // namespace beltpick::app
