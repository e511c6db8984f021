// What the self-test finds out about the PC it runs on. None of it takes longer than a second or changes anything.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "service/self_test_facts.hpp"

namespace beltpick::service {

// Whether files can be written there, tried with one that is removed again. A folder that is not there is not made: its
// nearest parent tells whether it could be.
FolderFound find_folder(const std::filesystem::path& path);

ClockFound find_clock();

// Asks the kernel for a receive buffer of so many bytes, as the camera's stream does.
SocketBufferFound find_socket_buffer(std::int64_t wanted_bytes, std::int64_t frame_bytes);

struct InterfaceFound {
  std::string name;  // empty: not known
  int mtu = 0;
};
// The network interface on the way to an IPv4 address.
InterfaceFound find_interface(const std::string& address);

// Whether a TCP port could be served, tried by opening it: kFree, kTaken, kForbidden or kNoSuchAddress.
PortFound find_port(const std::string& address, int port);

// What a running beltpickd says on its Modbus port; nothing where another program serves it.
struct DaemonWord {
  std::uint16_t state = 0, fault_code = 0, last_code = 0;
};
std::optional<DaemonWord> ask_daemon(const std::string& address, int port);

// Whether a thread of this process may have real-time priority.
bool realtime_allowed();

// The certificate in the service's state folder; `expected` is the caller's to set.
CertificateFound find_certificate(const std::filesystem::path& state);

}  // namespace beltpick::service
