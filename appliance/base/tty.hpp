// A serial line of the PC, opened raw and for us alone.
#pragma once

#include <cstdint>
#include <expected>

namespace beltpick {

enum class TtyFault : std::uint8_t { kCannotOpen, kInUse, kNotATty };

struct TtyError {
  TtyFault fault = TtyFault::kCannotOpen;
  int error = 0;  // errno of kCannotOpen
};

// Opens `path` raw, non-blocking, 500000 baud, and locks it against a second beltpick program. The file descriptor is
// the caller's to close, which ends the lock. Closing does not drop DTR: a board that resets on it would never finish
// starting while we look for it.
std::expected<int, TtyError> open_tty(const char* path);

}  // namespace beltpick
