// A tty opened raw for the trigger protocol.
#pragma once

#include "base/result.hpp"

namespace beltpick::capture {

// Opens `path` raw, non-blocking, 500000 baud, and locks it against a second beltpick program. The file descriptor is
// the caller's to close. kTriggerLost with the reason. Closing does not drop DTR: a board that resets on it would never
// finish starting while we look for it.
Result<int> open_serial(const char* path);

}  // namespace beltpick::capture
