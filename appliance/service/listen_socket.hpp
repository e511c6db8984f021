// The socket that the service listens on.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.hpp"
#include "service/folder.hpp"

namespace beltpick::service {

// `address`: IPv4 or IPv6 in numbers; "::" takes IPv4 too. Port 0: any free one. Errors: kValueOutOfRange (no such
// address), kUsage (the port cannot be had).
Result<Descriptor> listen_on(const std::string& address, std::uint16_t port);

// `address` as a URL's host: IPv6 in brackets, so that a port can follow.
std::string url_host(const std::string& address);

// The port it really has.
std::uint16_t port_of(const Descriptor& socket);

}  // namespace beltpick::service
