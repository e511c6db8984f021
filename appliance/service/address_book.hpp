// AddressBook: how much each address asks, and how often with a wrong token; a fixed number of addresses is kept.
#pragma once

#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <string>

namespace beltpick::service {

// Where a client comes from: an IPv4 address, or the /64 network of an IPv6 one, of which a client has all addresses.
struct ClientAddress {
  std::array<std::uint8_t, 16> key{};

  friend bool operator==(const ClientAddress&, const ClientAddress&) = default;
};

ClientAddress client_address(const sockaddr* address);
// "192.168.0.7" or "2001:db8::/64", for the log.
std::string address_text(const ClientAddress& address);

class AddressBook {
 public:
  static constexpr int kWrongTokens = 5;  // in a minute; then none is heard until the minute is over
  static constexpr std::int64_t kMinute_us = 60'000'000;
  static constexpr std::size_t kAddresses = 256;  // those that came last

  explicit AddressBook(int requests_per_minute);

  // Counts a request. Returns 0 where it may be answered, else the seconds to wait.
  int ask(const ClientAddress& address, std::int64_t now_us);
  // The seconds until tokens of that address are heard again; 0: they are.
  int locked_for(const ClientAddress& address, std::int64_t now_us);
  void wrong_token(const ClientAddress& address, std::int64_t now_us);

 private:
  struct Page {
    ClientAddress address;
    std::int64_t seen_us = 0;  // 0: free
    double allowance = 0;      // requests that may come at once
    int wrong = 0;
    std::int64_t first_wrong_us = 0;
  };

  Page& page(const ClientAddress& address, std::int64_t now_us);

  double per_us_;
  double most_;
  std::array<Page, kAddresses> pages_{};
};

}  // namespace beltpick::service
