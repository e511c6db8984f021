// Address: where an appliance's service listens, as a person writes it after --to.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "contract/api.hpp"

namespace beltpick::link {

struct Address {
  std::string host;  // a name in lower case, or an IPv4 or IPv6 address without brackets
  std::uint16_t port = kDefaultServicePort;

  // "cell4:8443", "[fe80::1%eth0]:8443".
  [[nodiscard]] std::string text() const;
  // "https://cell4:8443", without a path.
  [[nodiscard]] std::string url() const;
  // Of the file that keeps what is known of it: "cell4_8443".
  [[nodiscard]] std::string file_stem() const;

  friend bool operator==(const Address&, const Address&) = default;
};

// HOST, HOST:PORT, an IPv4 address likewise, an IPv6 address bare or as [ADDRESS]:PORT. Error: kUsage.
Result<Address> parse_address(std::string_view text);

}  // namespace beltpick::link
