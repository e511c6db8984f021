// The kernel's receive buffer of the camera's stream. Aravis 0.8 sizes it only once the first frame has begun, and
// never beyond net.core.rmem_max, which by default is a fifth of a frame: a stream thread that is scheduled late then
// loses whole frames.
#pragma once

#include <cstdint>

namespace beltpick::capture {

inline constexpr int kStreamSocketBytes = 16 << 20;  // a good half of a sequence, until the stream thread is scheduled

// Enlarges the receive buffer of this process' UDP socket at `port` (host byte order): beyond the kernel's limit where
// the process may (CAP_NET_ADMIN), else up to it.
void enlarge_receive_buffer(std::uint16_t port, int bytes);

}  // namespace beltpick::capture
