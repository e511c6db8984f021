// Reach: whether an appliance's name resolves and its port is open, each by itself, for those who look for the fault.
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "link/address.hpp"

namespace beltpick::link {

// The numeric addresses of the host, at least one. Error: kServiceUnreachable.
Result<std::vector<std::string>> resolve(const Address& address);

// Opens a TCP connection to the first of the host's addresses that takes one within `timeout_ms`, and closes it.
// Returns that address. Error: kServiceUnreachable.
Result<std::string> knock(const Address& address, int timeout_ms = 3000);

}  // namespace beltpick::link
