// The trigger box's tty, opened for the trigger protocol.
#pragma once

#include "base/result.hpp"

namespace beltpick::capture {

// As open_tty() has it. kTriggerLost with the reason.
Result<int> open_serial(const char* path);

}  // namespace beltpick::capture
