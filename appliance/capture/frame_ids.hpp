// Frame ids of GigE Vision: 16 bits that run from 1 to 65535 and wrap to 1, or 64 bits in extended mode.
#pragma once

#include <cstdint>

namespace beltpick::capture {

// How many frames the camera went on from `before` to `now`: 1 is the next frame, 3 means that two are missing, 0 is
// the same frame again, below 0 an older one.
std::int64_t frames_between(std::uint64_t before, std::uint64_t now);

}  // namespace beltpick::capture
